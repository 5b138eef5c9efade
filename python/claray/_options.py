"""What renders can be asked for, and what they tell, by names."""

from __future__ import annotations

import os
from typing import Any, Literal, Mapping, Sequence, TypedDict, Union, cast

from . import _native
from ._arrays import did_you_mean, names_of
from .errors import UsageError

Sampler = Literal["sobol", "independent"]
Denoiser = Literal["automatic", "claray", "oidn"]
ToneMap = Literal["aces", "none"]
Layout = Literal["automatic", "binary", "wide"]
Builder = Literal["automatic", "fast", "balanced", "high", "binned"]
NormalPacking = Literal["octahedral", "spherical"]
Approximation = Literal["tile-sum", "light-grid", "flat", "gouraud", "no-shadows"]
AnyPath = Union[str, "os.PathLike[str]"]


class BvhOptions(TypedDict, total=False):
    """How the tree of a render is built.

    builder, layout, split_budget, learns: as of Bvh. morton_bits: of each Morton code, 30 or 63. max_leaf_triangles: of the
    binary layout, up to 4.
    """

    builder: Builder
    morton_bits: Literal[30, 63]
    layout: Layout
    split_budget: float
    max_leaf_triangles: int
    learns: bool | None


class LightGridOptions(TypedDict, total=False):
    """The grid of probes of the approximation "light-grid" (Greger et al. 1998, "The irradiance volume").

    side: probes per axis, 2 to 64. coefficients: of each colour, 4 or 9. levels: 1 to 4; each finer one has a quarter of the
    spacing and follows the camera. gather: surfaces that a path meets before the grid answers. rays: per probe and update, 8
    to 4096. updates: before the first image. voxels: voxels in place of probes, which give light to surfaces next to them.
    """

    voxels: bool
    side: int
    coefficients: Literal[4, 9]
    levels: int
    gather: int
    rays: int
    updates: int


class RenderOptions(TypedDict, total=False):
    """Options of Renderer and render; docs/effects.md and docs/accuracy.md describe them.

    width, height: pixels, 1 to 2**14. spp: samples per pixel at which rendering stops. seconds, noise, error: if > 0, stop
    after this time, at this relative standard error, or at this error (RMSE over the mean). max_depth: surfaces that scatter a
    path; 1 is direct light only. sample_clamp: if > 0, samples above this radiance are scaled down to it, which darkens the
    image. seed: of the random numbers. sampler: of their source.
    adaptive: more samples where the error is large. guide: paths learn where light comes from, on CPUs. report_seconds:
    between two calls of `progress`.
    bvh: how the tree is built. parts: so many trees, by space; 0: as many as the memory requires. effects: for experiments,
    effects that are compiled in or removed, "+textures,-sky". approximate: cheaper answers, one or several names. light_grid:
    of the approximation "light-grid". compiler: the program `claray`, to compile kernels in the background.
    region: left, top, width and height of the pixels that are rendered, with the bits of the whole image; images have its size.
    lobes, light_groups: layers of the image's light, see light_layers(). light_groups: the names of lights and of emissive materials of
    each group, "light:3", "material:0" or "sky".
    alpha: the background is transparent, and images are premultiplied by `alpha()`; see Material.role.
    checkpoint: a file that is written each checkpoint_seconds, and at the end. resume: a checkpoint from which to continue.
    """

    width: int
    height: int
    spp: int
    max_depth: int
    sample_clamp: float
    seed: int
    seconds: float
    noise: float
    error: float
    adaptive: bool
    guide: bool
    report_seconds: float
    sampler: Sampler
    bvh: BvhOptions
    parts: int
    effects: str
    approximate: Approximation | Sequence[Approximation]
    light_grid: LightGridOptions
    compiler: str
    checkpoint: AnyPath
    checkpoint_seconds: float
    resume: AnyPath
    region: tuple[int, int, int, int]
    alpha: bool
    lobes: bool
    light_groups: Mapping[str, Sequence[str]]


class LightMapOptions(TypedDict, total=False):
    """Options of bake_light_map: width, height: texels. spp: paths per texel. uv_set: the texture coordinates that map the
    mesh to 0..1 without overlaps, 0 or 1. max_depth, seed, sampler, bvh: as of RenderOptions."""

    width: int
    height: int
    spp: int
    max_depth: int
    seed: int
    uv_set: Literal[0, 1]
    sampler: Sampler
    bvh: BvhOptions


class RenderProgress(TypedDict):
    """How far a render is.

    spp: samples per pixel, the mean rounded down. seconds: since the first sample. noise: standard error of luminance over the
    mean; 0: unknown. error, error_bound: estimates of RMSE over the mean, if the option `error` is set. error_of_fireflies: the
    part of the squared error that single bright pixels have. error_is_sure: whether they leave the estimate certain. error_spp:
    samples per pixel when it was made. cut_off: light missing beyond max_depth. own_kernels: whether the scene's own kernels
    are in use. waits_for_kernels: whether sampling pauses while they are compiled. dropped_samples: not finite or above 1e30.
    culled: triangles left out.
    """

    spp: int
    spp_target: int
    seconds: float
    noise: float
    error: float
    error_bound: float
    error_of_fireflies: float
    error_is_sure: bool
    error_spp: int
    cut_off: float
    own_kernels: bool
    waits_for_kernels: bool
    dropped_samples: int
    culled: int


class RayCount(TypedDict):
    """Rays traced, and the device's time for it; 0: unknown."""

    rays: int
    milliseconds: float


class TreeStatistics(TypedDict):
    """Counts of triangles, culled triangles and additional references, height, SAH cost, bytes on the device."""

    triangles: int
    culled: int
    references: int
    height: int
    sah_cost: float
    bytes: int


class RenderStatistics(TypedDict):
    """What a render took.

    first_pixel_seconds: from the renderer's construction to the first samples. start: the kernels with which it started: the
    scene's own, "generic" ones or those that compile "quick". own_kernels_from: samples per pixel that were done when its own took
    over. camera, bounce, shadow: rays by their purpose; in_paths: those of them that a kernel of whole paths traced.
    effects: those of the scene, by names. device_bytes: of this renderer's buffers. most_device_bytes: the most of all buffers of
    the device. parts: of the tree. bytes_paged: copied because parts took turns. longest_milliseconds: of the command
    longest_command. measuring_seconds: for estimates of noise and error. adapted: whether some pixels got more samples than
    others. guided: whether paths were guided.
    """

    first_pixel_seconds: float
    first_pixel_processor_seconds: float
    start: Literal["own", "generic", "quick"]
    own_kernels_from: int
    own_kernels: bool
    build_milliseconds: float
    bvh: TreeStatistics
    primitives: int
    camera: RayCount
    bounce: RayCount
    shadow: RayCount
    in_paths: RayCount
    effects: str
    device_bytes: int
    most_device_bytes: int
    parts: int
    bytes_paged: int
    longest_milliseconds: float
    longest_command: str
    dropped_samples: int
    measuring_seconds: float
    adapted: bool
    guided: bool


class DeviceShare(TypedDict):
    """What a device contributed to an image: paths, its measured speed, and why it was dropped (empty: it was not)."""

    name: str
    samples: int
    samples_per_second: float
    failure: str


def set_option(native: Any, key: str, value: Any, of: str, path: str) -> None:
    """Sets a member of a native configuration, or those of one within it. `path`: its name in errors."""
    if key.startswith("_") or not hasattr(native, key):
        raise UsageError(f"{path}: unknown option of {of}{did_you_mean(key, dir(native))}")
    current = getattr(native, key)
    type_name = type(current).__name__
    if key == "approximate":
        value = names_of("approximate", value) or "nothing"
    if type_name.startswith("Native"):
        _set_inner(current, value, of, path)
        return
    if key == "light_groups":
        value = _groups_of(value)
    is_path = isinstance(current, os.PathLike)
    try:
        if is_path:
            value = str(os.fspath(value))  # pyright: ignore[reportUnknownArgumentType]  # a path of bytes, too
        elif isinstance(value, (bool, str)) and type(value) is not type(current) and current is not None:
            raise TypeError  # float("1") is a number, too
        setattr(native, key, value)
    except (TypeError, OverflowError):
        kind = {"str": "a text", "bool": "True or False"}.get(type_name, "a path" if is_path else "a number")
        raise UsageError(f"{path}: {value!r} is not {kind} of this option's type and range") from None


def _groups_of(value: Any) -> list[str]:
    """The texts of RenderConfig::light_groups."""
    if not isinstance(value, Mapping):
        raise UsageError(f"light_groups: is {value!r}; use a dict of names and lists of lights")
    groups = cast("Mapping[str, Any]", value)
    return [f"{name}={names_of(f'light_groups[{name!r}]', lights)}" for name, lights in groups.items()]


def _set_inner(native: Any, options: Any, of: str, path: str) -> None:
    if not isinstance(options, Mapping):
        raise UsageError(f"{path}: is {options!r}; use a dict of options")
    for name, value in cast("Mapping[str, Any]", options).items():
        set_option(native, name, value, of, f"{path}.{name}")


def config_of(options: Mapping[str, Any]) -> Any:
    config = _native.NativeRenderConfig()
    for key, value in options.items():
        set_option(config, key, value, "a render", key)
    return config


def light_map_config_of(options: Mapping[str, Any]) -> Any:
    config = _native.NativeLightMapConfig()
    for key, value in options.items():
        set_option(config, key, value, "a light map", key)
    return config
