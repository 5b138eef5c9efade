"""The path tracer."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._device import AnyDevice, device_of
from ._handle import Handle
from ._image import Image
from ._scene import Scene
from .errors import UsageError


def config_of(options: dict[str, Any]) -> Any:
    config = _native.NativeRenderConfig()
    for key, value in options.items():
        if not hasattr(config, key):
            raise UsageError(f"{key}: unknown option of a render")
        try:
            if isinstance(value, (bool, str)):  # float("1") is a number, too
                raise TypeError
            setattr(config, key, value)
        except (TypeError, OverflowError):
            raise UsageError(f"{key}: {value!r} is not a number of this option's type and range") from None
    return config


class Renderer(Handle):
    """Renders a scene by path tracing. The same options give the same image bit for bit.

    scene: a Scene; later changes of it take effect by update(). device: as of Bvh.
    width, height: pixels. spp: samples per pixel at which rendering stops. seconds, noise, error: if > 0, stop after
    this time, at this relative standard error, or at this error (RMSE over the mean). max_depth: surfaces per path.
    sample_clamp: if > 0, samples above this radiance are scaled down to it. seed: of the random numbers. Raises UsageError, InputError for an invalid scene, DeviceError.
    """

    __slots__ = ("_native", "_rendered")
    _instead_of_pickling = "make it in each process; its image() is an array, which can be pickled"

    def __init__(self, scene: Scene, *, width: int = 512, height: int = 512, spp: int = 64, device: AnyDevice = None,
                 **options: Any) -> None:
        if not isinstance(scene, Scene):
            raise UsageError(f"scene: is a {type(scene).__name__}; use a claray.Scene")
        scene._warn_of_added_light()
        scene._warn_of_lamps()
        config = config_of({"width": width, "height": height, "spp": spp, **options})
        self._native = _native.NativeRenderer.make(device_of(device)._native, scene._native, config)
        self._rendered = False

    def render(self, progress: Callable[[dict[str, Any]], Any] | None = None) -> dict[str, Any]:
        """Adds samples until a target is reached, and returns the progress: spp, seconds, noise, error.

        progress: called several times a second with such a dict; returns False to stop. If it raises, rendering stops
        after the current samples and the exception is raised here; the image so far is kept. So does Ctrl-C.
        """
        self._rendered = True
        return self._native.render(progress)

    def image(self, denoise: bool | str = False) -> Image:
        """The mean radiance so far, as an array of float32 (height, width, 3). Renders first if nothing is rendered yet.

        denoise: False, True, or the denoiser: "claray" or "oidn".
        """
        if not self._rendered:
            self.render()
        name = "automatic" if denoise is True else denoise or None
        return self._native.image(name).view(Image)

    def release_denoiser(self) -> None:
        """Gives back the memory that image(denoise=...) keeps for the next image. A later image takes it again."""
        self._native.release_denoiser()

    @property
    def device_bytes(self) -> int:
        """Memory of the device that this renderer holds, with that of its denoiser."""
        return self._native.device_bytes()

    def aovs(self) -> dict[str, NDArray[Any]]:
        """Of the first surface at each pixel's centre: 'depth' (distance, inf: nothing), 'normal', 'albedo', 'primitive'
        and 'material' (numbers; MISS: nothing), and 'heat' (boxes and triangles tested), each (height, width) or (height, width, 3)."""
        return self._native.aovs()

    def error_map(self) -> NDArray[np.float32]:
        """Half the width of each pixel's interval, (height, width): 19 of 20 hold the pixel's true luminance, unless there are
        fireflies. Renders first if nothing is rendered yet, and some pixels again."""
        if not self._rendered:
            self.render()
        return self._native.error_map()

    def update(self, scene: Scene, *, camera: bool = False, lights: bool = False, materials: bool = False, sky: bool = False) -> None:
        """Discards all samples and continues with a scene that differs in these parts only."""
        if not isinstance(scene, Scene):
            raise UsageError(f"scene: is a {type(scene).__name__}; use a claray.Scene")
        self._native.update(scene._native, camera, lights, materials, sky)
        self._rendered = False

    def restart(self, seed: int) -> None:
        """Discards all samples and restarts with another seed."""
        self._native.restart(seed)
        self._rendered = False

    def __repr__(self) -> str:
        width, height = self._native.size()
        return f"<claray.Renderer of {width} x {height} pixels on {self._native.device().info()['name']}>"

    def _repr_png_(self) -> bytes | None:
        return self.image()._repr_png_() if self._rendered else None


def render(scene: Scene, **options: Any) -> Image:
    """Renders an image: Renderer(scene, **options).image()."""
    return Renderer(scene, **options).image()


def prepare(scene: Scene | None = None, *, device: AnyDevice = None, denoise: bool | str = False, **options: Any) -> None:
    """Compiles kernels ahead, into the cache on disk, so that later calls and processes start without delay.

    Without a scene: what structures and queries need. With one: what its renders need, and image(denoise=...). device: as
    for Bvh. options: as for Renderer. Says on standard error what is compiled (tell_compiling).
    Blocks: up to a minute on a GPU where claray never ran. Raises DeviceError with the compiler's log.
    """
    on = device_of(device)
    if scene is None:
        if options or denoise:
            raise UsageError("prepare: options of renders need a scene")
        on._native.prepare()
        return
    size = {"width": 64, "height": 64, "spp": 1}
    Renderer(scene, device=device, **{**options, **size}).image(denoise)


def tell_compiling(on: bool) -> None:
    """Whether standard error says which kernels are compiled and how far that is (the default)."""
    _native.tell_compiling(on)
