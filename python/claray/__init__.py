"""claray: exact ray queries and path tracing on CPUs and GPUs, by OpenCL.

    bvh = claray.Bvh(vertices, triangles)
    hits = claray.closest_hit(bvh, origins, directions)
    hits["t"], hits["primitive"]
"""

from . import errors
from ._accuracy import Study, accuracy, studies
from ._arrays import HIT, MISS, RAY
from ._bvh import Bvh
from ._device import Device, Event, default_device, devices
from ._image import Image
from ._query import Query, Rays, any_hit, closest_hit, rays, unoccluded
from ._render import Renderer, render
from ._scene import Camera, Light, Material, Scene, builtin_scenes, load
from ._verify import verify, verify_cases
from .errors import DeviceError, Error, InputError, UsageError

__all__ = [
    "HIT", "MISS", "RAY", "Bvh", "Camera", "Device", "DeviceError", "Error", "Event", "Image", "InputError", "Light",
    "Material", "Query", "Rays", "Renderer", "Scene", "Study", "UsageError", "accuracy", "any_hit", "builtin_scenes", "closest_hit",
    "default_device", "devices", "errors", "load", "rays", "render", "studies", "unoccluded", "verify", "verify_cases",
]
