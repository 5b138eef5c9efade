"""Scenes: loaded from files, built in, or put together from arrays."""

from __future__ import annotations

import os
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import finite, floats, indices
from .errors import UsageError


def _set_all(native: Any, name: str, values: dict[str, Any]) -> Any:
    for key, value in values.items():
        if not hasattr(native, key):
            raise UsageError(f"{name}: has no property '{key}'")
        try:
            setattr(native, key, value)
        except TypeError:
            raise UsageError(f"{key}: {value!r} does not fit a {name}") from None
    return native


def Material(kind: str = "lambert", **properties: Any) -> Any:
    """A material: kind is "lambert", "mirror", "glass", "metal", "blinn-phong", "principled" or "unlit".

    properties: albedo, emission, specular, sheen (three numbers each, linear Rec. 709; emission is radiance in
    W / (m^2 sr)); roughness, ior, metallic, transmission, clearcoat, clearcoat_roughness, sheen_roughness, anisotropy,
    opacity, shininess (numbers); thin_walled, cull_back (bool); name. All can be read and set later.
    """
    return _set_all(_native.NativeMaterial(), "Material", {"kind": kind, **properties})


def Light(kind: str = "point", **properties: Any) -> Any:
    """A light: kind is "point", "spot", "directional" or "sun".

    properties: position, direction, intensity (three numbers each; W / sr, or W / m^2 for far lights), inner_angle,
    outer_angle (radians), range (0: none), name.
    """
    return _set_all(_native.NativeLight(), "Light", {"kind": kind, **properties})


def Camera(**properties: Any) -> Any:
    """A camera: position, target, up (three numbers each), vertical_fov (degrees), aperture_radius, focus_distance,
    orthographic_height (0: perspective)."""
    return _set_all(_native.NativeCamera(), "Camera", properties)


class Scene:
    """Meshes, materials, lights, sky and camera. An empty scene; load() makes one from a file."""

    def __init__(self) -> None:
        self._native = _native.NativeScene()
        self._added_light: str | None = None

    @classmethod
    def _of(cls, native: Any, added_light: str | None = None) -> Scene:
        scene = cls.__new__(cls)
        scene._native = native
        scene._added_light = added_light
        return scene

    def add_material(self, material: Any = None, **properties: Any) -> int:
        """Adds a Material, or one of these properties, and returns its number."""
        self._native.materials = [*self._native.materials, Material(**properties) if material is None else material]
        return len(self._native.materials) - 1

    def add_light(self, light: Any = None, **properties: Any) -> int:
        """Adds a Light, or one of these properties, and returns its number."""
        self._native.lights = [*self._native.lights, Light(**properties) if light is None else light]
        self._added_light = None
        return len(self._native.lights) - 1

    def add_mesh(self, vertices: ArrayLike, triangles: ArrayLike, *, normals: ArrayLike | None = None,
                 uvs: ArrayLike | None = None, material: int = 0, name: str = "", mask: int = 0xFFFFFFFF) -> int:
        """Adds a mesh and returns its number.

        vertices: (V, 3). triangles: (T, 3) indices of vertices. normals: (V, 3) of unit length; None: flat shading.
        uvs: (V, 2), (0, 0) is an image's top left corner. material: number from add_material. mask: for masks of rays.
        """
        points = finite("vertices", floats("vertices", vertices, 3))
        faces = indices("triangles", triangles, 3, len(points), "vertices")
        directions = finite("normals", floats("normals", [] if normals is None else normals, 3)) if normals is not None else np.empty((0, 3), np.float32)
        places = finite("uvs", floats("uvs", uvs, 2)) if uvs is not None else np.empty((0, 2), np.float32)
        for key, array in (("normals", directions), ("uvs", places)):
            if len(array) not in (0, len(points)):
                raise UsageError(f"{key}: has {len(array)} rows, but vertices has {len(points)}")
        return self._native.add_mesh(name, points, faces, directions, places, material, mask)

    @property
    def meshes(self) -> list[dict[str, Any]]:
        """The meshes: name, and read-only views 'vertices' (V, 3), 'triangles' (T, 3), 'normals', 'uvs', 'materials'."""
        return [self._native.mesh_at(i) for i in range(self._native.mesh_count())]

    @property
    def instances(self) -> dict[str, Any]:
        """Where meshes are: 'meshes' (N,), the mesh of each instance; 'transforms' (N, 3, 4), from its coordinates to those
        of the world; 'ends', the same at time 1, or None if nothing moves."""
        meshes, begin, end = self._native.placements()
        rows = np.array(begin, np.float32).reshape(-1, 3, 4)
        ends = np.array(end, np.float32).reshape(-1, 3, 4)
        return {"meshes": np.array(meshes, np.uint32), "transforms": rows, "ends": None if (rows == ends).all() else ends}

    @property
    def triangle_count(self) -> int:
        return self._native.triangle_count()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The box of all placed meshes: (2, 3), lowest and highest corner."""
        return np.array(self._native.bounds())

    @property
    def materials(self) -> list[Any]:
        """Copies of the materials. Assign a list to change them."""
        return self._native.materials

    @materials.setter
    def materials(self, materials: list[Any]) -> None:
        self._native.materials = list(materials)

    @property
    def lights(self) -> list[Any]:
        """Copies of the lights. Assign a list to change them."""
        return self._native.lights

    @lights.setter
    def lights(self, lights: list[Any]) -> None:
        self._native.lights = list(lights)
        self._added_light = None

    @property
    def camera(self) -> Any:
        """A copy of the camera, or of one that sees the whole scene. Assign a Camera to change it."""
        return self._native.camera

    @camera.setter
    def camera(self, camera: Any) -> None:
        self._native.camera = camera

    @property
    def sky(self) -> tuple[Any, Any]:
        """Radiance of rays that leave the scene: at the horizon and at the zenith, three numbers each."""
        return self._native.sky

    @sky.setter
    def sky(self, colors: Any) -> None:
        pair = colors if len(colors) == 2 else (colors, colors)
        self._native.sky = (tuple(pair[0]), tuple(pair[1]))
        self._added_light = None

    def _warn_of_added_light(self) -> None:
        """Warns, once, of light that load() added and the caller has not replaced."""
        if self._added_light:
            warnings.warn(self._added_light + "; choose other light by Scene.sky or Scene.add_light", stacklevel=3)
        self._added_light = None

    def copy(self) -> Scene:
        return Scene._of(self._native.copy(), self._added_light)

    def __repr__(self) -> str:
        return f"<claray.Scene '{self._native.name}' of {self._native.mesh_count()} meshes, {self.triangle_count} triangles>"


def load(name_or_path: str | os.PathLike[str], **choices: Any) -> Scene:
    """Loads a scene: a file (.obj, .gltf, .glb, .ply, .stl), or a built-in scene such as "cornell" (builtin_scenes()).

    choices, for glTF only: time (seconds of an animation), animation, variant, camera, scene (a name or an index).
    What a loader corrects or leaves out is reported by warnings.warn. A file whose own light shows hardly anything gets a
    pale sky or a lamp, of which a renderer warns; queries need no light. Raises InputError, naming the file, for a damaged
    one, and UsageError for an unknown scene or choice.
    """
    options = _set_all(_native.NativeLoadOptions(), "load", choices)
    native, messages, added_light = _native.load(os.fspath(name_or_path), options)
    for message in messages:
        warnings.warn(message, stacklevel=2)
    return Scene._of(native, added_light)


def builtin_scenes() -> list[str]:
    """The names of the built-in scenes."""
    return _native.builtin_scene_names()
