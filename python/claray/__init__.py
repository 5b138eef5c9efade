"""Exact ray queries and path tracing on CPUs and GPUs, by OpenCL.

```python
bvh = claray.Bvh(vertices, triangles)
hits = claray.closest_hit(bvh, origins, directions)
hits["t"], hits["primitive"]
```
"""

from . import _loader, _native, errors  # the loader first: it finds what the extension module needs
from ._accuracy import Study, accuracy, studies
from ._arrays import HIT, INSTANCE_HIT, MISS, NEAREST, RAY
from ._bvh import Bvh
from ._device import Device, Event, default_device, devices
from ._filter import Filter, geometry_range
from ._image import Image
from ._instances import InstancedBvh
from ._levels import FlatInstances, Instances, flatten
from ._lists import Lists, all_hits, box_overlaps, count_hits, nearest_hits, sphere_overlaps
from ._points import inside, nearest_point, signed_distance
from ._primitives import Primitives
from ._query import Query, Rays, any_hit, closest_hit, rays, unoccluded
from ._render import Renderer, prepare, render, tell_compiling
from ._scene import Camera, Light, Material, Scene, builtin_scenes, load
from ._verify import verify, verify_cases
from .errors import DeviceError, Error, InputError, UsageError

del _loader
__version__: str = _native.version

__all__ = [
    "HIT", "INSTANCE_HIT", "MISS", "NEAREST", "RAY", "Bvh", "Camera", "Device", "DeviceError", "Error", "Event", "Filter",
    "FlatInstances", "Image", "InputError", "InstancedBvh", "Instances", "Light", "Lists", "Material", "Primitives",
    "Query", "Rays", "Renderer", "Scene", "Study", "UsageError", "accuracy", "all_hits", "any_hit", "box_overlaps",
    "builtin_scenes", "closest_hit", "count_hits", "default_device", "devices", "errors", "flatten", "geometry_range",
    "inside", "load", "nearest_hits", "nearest_point", "prepare", "rays", "render", "signed_distance", "sphere_overlaps",
    "studies", "tell_compiling", "unoccluded", "verify", "verify_cases",
]
