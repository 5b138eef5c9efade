"""The path tracer."""

from __future__ import annotations

import threading
from typing import Any, Literal, Sequence, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import flag, integer, names_of, naming, number, output, text
from ._device import AnyDevice, Device, device_of
from ._handle import Handle, warn
from ._image import Cryptomatte, Image, pixels_of
from ._options import (BvhOptions, Denoiser, DeviceShare, NormalPacking, RenderOptions, RenderProgress, RenderStatistics, ToneMap,
                       config_of)
from ._progress import Progress, Report, reports
from ._scene import Scene
from ._typing import Unpack
from ._values import GBUFFER, GBuffer
from .errors import UsageError

AnyDevices = Union[AnyDevice, Sequence[AnyDevice]]


def native_scene(scene: Any) -> Any:
    if not isinstance(scene, Scene):
        raise UsageError(f"scene: is a {type(scene).__name__}; use a claray.Scene")
    return scene._native


def _devices_of(device: Any) -> list[Device]:
    if not isinstance(device, (list, tuple)):
        return [device_of(device)]
    several = [device_of(one) for one in cast("Sequence[AnyDevice]", device)]
    if not several:
        raise UsageError("device: is empty; give at least one device")
    return several


class Renderer(Handle):
    """Renders a scene by path tracing. The same options give the same image bit for bit.

    scene: a Scene; later changes of it take effect by update(). device: as of Bvh; or a list of devices, which share the image:
    together they give the image of one bit for bit. One that fails is left out, with a warning. options: as of RenderOptions.
    Raises UsageError, naming the option; InputError for an invalid scene or checkpoint; DeviceError.
    """

    __slots__ = ("_config", "_devices", "_instances", "_native", "_rendered")
    _native: Any
    _instead_of_pickling = "make it in each process; its image() is an array, which can be pickled"

    def __init__(self, scene: Scene, *, device: AnyDevices = None, **options: Unpack[RenderOptions]) -> None:
        native = native_scene(scene)
        scene._warn_of_added_light()
        scene._warn_of_lamps()
        self._devices, self._config = _devices_of(device), config_of(options)
        self._make(native)

    def _make(self, scene: Any) -> None:
        self._native = _native.NativeRenderer.make([device._native for device in self._devices], scene, self._config)
        self._instances, self._rendered = len(scene.placements()[0]), False

    def render(self, progress: Progress = None, *, seconds: float | None = None) -> RenderProgress:
        """Adds samples until a target is reached, and returns the progress.

        progress: a function that is called several times a second with the progress, and returns False to stop; True for a bar of
        tqdm, or a line on standard error where tqdm is not installed. If the function raises, rendering stops after the current
        samples and the exception is raised here; the image so far is kept. So does Ctrl-C. seconds: at most so many from now, but not
        before every pixel has a sample.
        """
        with reports(progress) as report:
            reached = self._render(report, seconds)
            if report is not None and not callable(progress):
                report(reached)
        return reached

    def _render(self, report: Report | None, seconds: float | None) -> RenderProgress:
        self._rendered = True
        try:
            return cast(RenderProgress, self._native.render(report, None if seconds is None else number("seconds", seconds)))
        finally:
            for line in self._native.take_failures():
                warn(line)

    async def render_async(self, progress: Progress = None, *, seconds: float | None = None) -> RenderProgress:
        """As render, in a thread, while the event loop goes on. `progress` is called in the loop's thread.

        If the task is cancelled, rendering stops after the samples that are under way, within about `report_seconds`; the image so
        far is kept, and another call continues.
        """
        import asyncio  # which takes longer to import than all else of this package

        loop, stop, raised = asyncio.get_running_loop(), threading.Event(), list[Exception]()
        with reports(progress) as report:
            def tell(reached: RenderProgress) -> None:
                try:
                    if report is not None and not stop.is_set() and report(reached) is False:
                        stop.set()
                except Exception as error:
                    raised.append(error)
                    stop.set()

            def tell_loop(reached: RenderProgress) -> bool:
                loop.call_soon_threadsafe(tell, reached)
                return not stop.is_set()

            work = loop.run_in_executor(None, self._render, tell_loop, seconds)
            cancelled = False
            while not work.done():
                try:
                    await asyncio.shield(work)
                except asyncio.CancelledError:
                    cancelled = True
                    stop.set()
                except Exception:
                    break  # raised below
            if cancelled:
                raise asyncio.CancelledError
            reached = work.result()
            if report is not None and not callable(progress):
                report(reached)
        if raised:
            raise raised[0]
        return reached

    def _rendered_once(self) -> Any:
        if not self._rendered:
            self.render()
        return self._native

    def image(self, denoise: bool | Denoiser = False, *, width: int = 0, height: int = 0, out: NDArray[np.float32] | None = None) -> Image:
        """The mean radiance so far, as an array of float32 (height, width, 3). Renders first if nothing is rendered yet.

        denoise: False, True, or the denoiser: "claray" or "oidn". width, height: another size, interpolated; 0: as rendered. out: an
        array to be filled.
        """
        native = self._rendered_once()
        by = denoise if isinstance(denoise, str) else "automatic" if flag("denoise", denoise) else None
        if by is not None:
            if width or height or out is not None:
                raise UsageError("denoise: has the size of the render, and its own memory; leave out width, height and out")
            return cast(Image, native.denoised(by).view(Image))
        full = native.size()
        for name, side in (("width", width), ("height", height)):
            if not isinstance(side, (int, np.integer)) or not 0 <= side <= 2**14:
                raise UsageError(f"{name}: is {side!r}; use 1 to {2**14} pixels, or 0 for those of the render")
        pixels = output("out", out, (int(height) or full[1], int(width) or full[0], 3), np.dtype(np.float32))
        native.image(pixels.view(np.ndarray))
        return pixels.view(Image)

    def alpha(self) -> NDArray[np.float32]:
        """The alpha of each pixel, (height, width), by which image() is premultiplied: the share of its camera rays that meet a surface
        first, as Material.role says. All 1 without the option `alpha`. Renders first if nothing is rendered yet."""
        return cast("NDArray[np.float32]", self._rendered_once().alpha())

    def picture(self, *, exposure: float = 0.0, tone_map: ToneMap = "aces", width: int = 0, height: int = 0,
                denoise: bool = False) -> NDArray[np.uint8]:
        """The image as uint8 (height, width, 3), converted on the device: exposure in stops, tone map "aces" or "none", sRGB. Renders first
        if nothing is rendered yet. width, height: another size, interpolated; 0: as rendered.

        denoise: by claray's own denoiser, for frames that are shown one after the other: after update(camera=True) or
        update(instances=True) light of the pictures before is used again where it fits.
        """
        native = self._rendered_once()
        size = integer("width", width, 0, 2**14), integer("height", height, 0, 2**14)
        return cast("NDArray[np.uint8]", native.picture(number("exposure", exposure), text("tone_map", tone_map), *size,
                                                        flag("denoise", denoise)))

    def release_denoiser(self) -> None:
        """Gives back the memory that image(denoise=...) keeps for the next image. A later image takes it again."""
        self._native.release_denoiser()

    @property
    def device_bytes(self) -> int:
        """Memory of the device that this renderer holds, with that of its denoiser."""
        return self.statistics()["device_bytes"]

    def statistics(self) -> RenderStatistics:
        """What the render took so far. May wait for a kernel to be compiled."""
        return cast(RenderStatistics, self._native.statistics())

    def aovs(self) -> dict[str, NDArray[Any]]:
        """Of the first surface at each pixel's centre: 'depth' (distance, inf: nothing), 'normal', 'albedo', 'primitive',
        'material', 'object' and 'instance' (numbers; MISS: nothing), 'heat' (boxes and triangles tested), 'position', 'uv',
        'roughness', 'emission' and 'motion' (pixels right and down until shutter close). docs/formats.md says more. Each has the
        shape (height, width) or (height, width, channels)."""
        return cast("dict[str, NDArray[Any]]", self._native.aovs())

    def cryptomatte(self, kind: Literal["object", "material", "asset"] = "object", samples: int = 64) -> Cryptomatte:
        """Which surfaces each pixel shows, and how much each covers, by so many camera rays per pixel.

        kind: "object" tells instances apart by their names, and in scenes without instances meshes; "material" tells materials apart,
        "asset" meshes, however often each is shown. Things of one name are one. Save it by Image.save(layers=...).
        """
        name, parts, manifest = self._native.cryptomatte(text("kind", kind), integer("samples", samples, 1, 2**24))
        return Cryptomatte(name, parts[..., 0].copy(), parts[..., 1].copy(), manifest)

    def light_layers(self) -> dict[str, NDArray[np.float32]]:
        """The light of the image in layers, (height, width, 3) each. Renders first if nothing is rendered yet.

        With the option `lobes`: 'lobe_emission', 'lobe_environment', and 'lobe_diffuse_direct' and so on, by how the first surface sends
        light to the camera. With `light_groups`: 'light_NAME' of each group, and 'light_rest' of all other lights. The sum of the lobes is
        the image; 'lobe_rest' is what rounding loses. The sum of the groups is the image, too.
        """
        return cast("dict[str, NDArray[np.float32]]", self._rendered_once().light_layers())

    def gbuffer(self, normals: NormalPacking = "octahedral") -> GBuffer:
        """The surfaces of aovs() in 12 bytes per pixel, as deferred renderers keep them. normals: how they are packed."""
        words, directions, positions, matrix = self._native.gbuffer(text("normals", normals))
        return GBuffer(words.view(GBUFFER)[..., 0], directions, positions, matrix)

    def voxels(self) -> NDArray[np.float32]:
        """The albedo of the surface in the voxel that each pixel's centre shows, (height, width, 3), for light_grid={"voxels": True}."""
        return cast("NDArray[np.float32]", self._native.voxels())

    def noise_map(self) -> NDArray[np.float32]:
        """The variance of each pixel's mean luminance over the square of the image's mean, (height, width). Renders first if
        nothing is rendered yet. 0: fewer than two samples."""
        return cast("NDArray[np.float32]", self._rendered_once().noise_map())

    def error_map(self) -> NDArray[np.float32]:
        """Half the width of each pixel's interval, (height, width): 19 of 20 hold the pixel's true luminance, unless there are
        fireflies. Renders first if nothing is rendered yet, and some pixels again."""
        return cast("NDArray[np.float32]", self._rendered_once().error_map())

    def error_of(self, image: ArrayLike) -> float:
        """An estimate of the error (RMSE over the mean) of an image of this render, such as a denoised one; 0: too small to tell.
        Renders first if nothing is rendered yet, and some pixels again."""
        return float(self._rendered_once().error_of(pixels_of("image", image)))

    def cut_off(self) -> float:
        """The share of light that is missing because paths end after max_depth surfaces, 0 to 1: an estimate."""
        return float(self._native.cut_off())

    def why_unguided(self) -> str:
        """Why the option `guide` guides no path although device, size and samples allow it; empty if it does."""
        return str(self._native.why_unguided())

    @property
    def checkpoint_error(self) -> str:
        """Why the last checkpoint could not be written; empty if it was written."""
        return str(self._native.checkpoint_error())

    @property
    def shares(self) -> list[DeviceShare]:
        """What each of several devices contributed; empty for one device."""
        return cast("list[DeviceShare]", self._native.shares())

    @property
    def devices(self) -> tuple[Device, ...]:
        return tuple(self._devices)

    def update(self, scene: Scene, *, camera: bool = False, lights: bool = False, materials: bool = False, sky: bool = False,
               instances: bool = False, vertices: bool = False, everything: bool = False) -> None:
        """Discards all samples and continues with a scene that differs in these parts only.

        camera, lights, sky: as they are called. materials: members, except their textures. instances: transforms; if their
        number changed, it counts as everything. vertices: places and normals of meshes. everything: uploads and builds anew.
        Raises UsageError for a render that writes checkpoints, and for meshes or materials of other numbers or sizes without
        `everything`; the renderer is then unchanged.
        """
        native = native_scene(scene)
        parts = {"camera": camera, "lights": lights, "materials": materials, "sky": sky, "instances": instances, "vertices": vertices}
        parts = {name: flag(name, value) for name, value in parts.items()}
        if flag("everything", everything) or (instances and len(native.placements()[0]) != self._instances):
            if self._config.checkpoint.name:
                raise UsageError("everything: a scene cannot change while checkpoints are written; leave out the checkpoint")
            self._make(native)
            return
        self._native.update(native, *parts.values())
        self._rendered = False

    def restart(self, seed: int, *, spp: int = 0, max_depth: int = 0) -> None:
        """Discards all samples and restarts with another seed. spp, max_depth: in place of those of the options, and not larger;
        0: those of the options."""
        self._native.restart(integer("seed", seed, 0, 2**32 - 1), integer("spp", spp, 0, 2**32 - 1),
                             integer("max_depth", max_depth, 0, 2**32 - 1))
        self._rendered = False

    def resize(self, width: int, height: int) -> None:
        """Discards all samples and makes the images this large. The view keeps its height."""
        self._native.resize(integer("width", width, 1, 2**31 - 1), integer("height", height, 1, 2**31 - 1))
        self._config.width, self._config.height = width, height
        self._rendered = False

    def settle(self) -> None:
        """Discards all samples and loads the fastest kernels for the scene, so that no later render waits for one."""
        self._native.settle()
        self._rendered = False

    def load_kernels(self) -> None:
        """Loads now what later renders would load while they run. Keeps all samples. Has no effect before the first sample."""
        self._native.load_kernels()

    def rebuild(self, **bvh: Unpack[BvhOptions]) -> bool:
        """Builds the tree again with other options; the image does not change. Returns False, and does nothing, if the scene has
        instances or its own kernels are not in use yet."""
        return bool(self._native.rebuild(config_of({"bvh": bvh}).bvh))

    def __repr__(self) -> str:
        width, height = self._native.size()
        return f"<claray.Renderer of {width} x {height} pixels on {', '.join(device.name for device in self._devices)}>"

    def _repr_png_(self) -> bytes | None:
        return self.image()._repr_png_() if self._rendered else None


def render(scene: Scene, *, device: AnyDevices = None, **options: Unpack[RenderOptions]) -> Image:
    """Renders an image: Renderer(scene, **options).image()."""
    return Renderer(scene, device=device, **options).image()


def approximation_error(approximate: Renderer, exact: Renderer) -> float:
    """The error (RMSE over the mean) of a render with the option `approximate`, beside one of the same scene and size without; 0: too small
    to tell. Renders the former first if nothing is rendered yet, and some pixels by both."""
    for name, renderer in (("approximate", approximate), ("exact", exact)):
        if not isinstance(renderer, Renderer):
            raise UsageError(f"{name}: is a {type(renderer).__name__}; use a claray.Renderer")
    return _native.approximation_error(approximate._rendered_once(), exact._native)


def prepare(scene: Scene | None = None, *, device: AnyDevice = None, denoise: bool | Denoiser = False,
            **options: Unpack[RenderOptions]) -> None:
    """Compiles kernels ahead, into the cache on disk, so that later calls and processes start without delay.

    Without a scene: what structures and queries need. With one: what its renders need, and image(denoise=...). device: as
    for Bvh. options: as for Renderer. Says on standard error what is compiled (tell_compiling).
    Blocks: up to a minute on a GPU where claray never ran. Raises DeviceError with the compiler's log.
    """
    on = device_of(device)
    if scene is None:
        if options or isinstance(denoise, str) or flag("denoise", denoise):
            raise UsageError("prepare: options of renders need a scene")
        on._native.prepare()
        return
    size: RenderOptions = {"width": 64, "height": 64, "spp": 1}
    given: RenderOptions = {**options, **size}
    Renderer(scene, device=device, **given).image(denoise)


def compile_kernels(effects: str | Sequence[str], /, *, device: AnyDevice = None, **options: Unpack[RenderOptions]) -> None:
    """Compiles the kernels of renders of scenes with exactly the effects of these names (Scene.effects()), into the cache on
    disk. Raises DeviceError with the compiler's log."""
    names, on, config = names_of("effects", effects), device_of(device), config_of(options)
    with naming("effects"):
        _native.compile_kernels(on._native, names, config)


def tell_compiling(on: bool) -> None:
    """Whether standard error says which kernels are compiled and how far that is (the default)."""
    _native.tell_compiling(on)
