"""Light that is rendered once and used by later images."""

from __future__ import annotations

from typing import Any, Callable

from numpy.typing import ArrayLike

from . import _native
from ._arrays import finite_vector, integer
from ._device import AnyDevice, device_of
from ._options import LightMapOptions, RenderOptions, config_of, light_map_config_of
from ._render import native_scene
from ._scene import Scene
from ._textures import Environment, Texture, environment_from, texture_from
from ._typing import Unpack
from .errors import UsageError


def bake_light_map(scene: Scene, mesh: int, *, device: AnyDevice = None, progress: Callable[[float], Any] | None = None,
                   **options: Unpack[LightMapOptions]) -> Texture:
    """The irradiance of the front of a mesh, in W / m^2, by path tracing from the centre of every texel that a triangle touches.

    options: as of LightMapOptions. progress: called with the share done, 0 to 1; returns False to stop, which raises InputError.
    Scene.use_light_map gives the map to the materials. Raises UsageError for options out of range, and InputError if the mesh lacks
    the coordinates, leaves 0..1 or overlaps itself, or if the scene has instances.
    """
    if progress is not None and not callable(progress):
        raise UsageError(f"progress: is {progress!r}; use a function or None")
    native, number = native_scene(scene), integer("mesh", mesh, 0, 2**31 - 1)
    return texture_from(_native.bake_light_map(device_of(device)._native, native, number, light_map_config_of(options), progress))


def render_probe(scene: Scene, position: ArrayLike, *, device: AnyDevice = None, **options: Unpack[RenderOptions]) -> Environment:
    """The light that arrives at a place, (3,), as the six faces of a cube of `height` pixels a side. The camera is ignored. options, errors:
    as of Renderer."""
    place = tuple(map(float, finite_vector("position", position, 3)))
    made = environment_from(_native.render_probe(device_of(device)._native, native_scene(scene), place, config_of(options)))
    assert made is not None
    return made
