"""Exact ray queries and path tracing on CPUs and GPUs, by OpenCL.

```python
bvh = claray.Bvh(vertices, triangles)
hits = claray.closest_hit(bvh, origins, directions)
hits["t"], hits["primitive"]
```
"""

from . import _loader, _native, errors  # the loader first: it finds what the extension module needs
from ._accuracy import Study, accuracy, studies
from ._arrays import HIT, INSTANCE_HIT, MISS, NEAREST, NEAREST64, RAY
from ._bake import bake_light_map, render_probe
from ._benchmark import Benchmark, benchmark
from ._bvh import Bvh
from ._device import Device, Event, default_device, devices
from ._explain import explain
from ._filter import Filter, geometry_range
from ._image import Cryptomatte, Image, false_color, identifier_color, image_error
from ._instances import InstancedBvh
from ._levels import FlatInstances, Instances, flatten
from ._lists import Lists, all_hits, box_overlaps, count_hits, nearest_hits, sphere_overlaps
from ._options import BvhOptions, LightGridOptions, LightMapOptions, RenderOptions, RenderProgress, RenderStatistics
from ._points import inside, nearest_point, signed_distance
from ._primitives import Primitives
from ._query import Query, Rays, any_hit, closest_hit, rays, unoccluded
from ._records import Camera, Light, Material, add_bsdf
from ._render import Renderer, approximation_error, compile_kernels, prepare, render, tell_compiling
from ._scene import LoadOptions, MeshArrays, Scene, animation_seconds, builtin_scenes, load
from ._textures import Environment, Texture
from ._values import GBUFFER, GBuffer, ImageError, TextureUse
from ._verify import verify, verify_cases
from ._view import View, view
from .errors import DeviceError, Error, InputError, UsageError

del _loader
__version__: str = _native.version

__all__ = [
    "GBUFFER", "HIT", "INSTANCE_HIT", "MISS", "NEAREST", "NEAREST64", "RAY", "Benchmark", "Bvh", "BvhOptions", "Camera",
    "Cryptomatte", "Device", "DeviceError", "Environment", "Error", "Event", "Filter", "FlatInstances", "GBuffer", "Image", "ImageError",
    "InputError", "InstancedBvh", "Instances", "Light", "LightGridOptions", "LightMapOptions", "Lists", "LoadOptions",
    "Material", "MeshArrays", "Primitives", "Query", "Rays", "RenderOptions", "RenderProgress", "RenderStatistics", "Renderer", "Scene",
    "Study", "Texture", "TextureUse", "UsageError", "View", "accuracy", "add_bsdf", "all_hits", "animation_seconds", "any_hit",
    "approximation_error", "bake_light_map", "benchmark", "box_overlaps", "builtin_scenes", "closest_hit", "compile_kernels",
    "count_hits", "default_device", "devices", "errors", "explain", "false_color", "flatten", "geometry_range",
    "identifier_color", "image_error", "inside", "load", "nearest_hits", "nearest_point", "prepare", "rays", "render",
    "render_probe", "signed_distance", "sphere_overlaps", "studies", "tell_compiling", "unoccluded", "verify", "verify_cases", "view",
]
