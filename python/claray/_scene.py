"""Scenes: loaded from files, built in, or put together from arrays."""

from __future__ import annotations

import os
import warnings
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import as_array, check_choice, finite, floats, indices, words
from ._primitives import curve_arrays, cylinder_rows, disc_rows, sphere_rows
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
    """Meshes, primitives, materials, lights, sky and camera. An empty scene; load() makes one from a file."""

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

    def _add_primitives(self, kind: str, points: NDArray[np.float32], segments: NDArray[np.uint32] | None, material: ArrayLike,
                        colors: ArrayLike | None, name: str) -> int:
        count = len(segments) if segments is not None else points.size // (4 if kind == "spheres" else 8)
        numbers = as_array("material", material)
        of_each = words("material", np.broadcast_to(numbers, (count,)) if numbers.ndim == 0 else numbers, count)
        tints = np.empty((0, 3), np.float32)
        if colors is not None:
            given = as_array("colors", colors)
            if given.ndim < 2:
                given = np.broadcast_to(given, (count, 3))
            if given.shape not in ((count, 3), (count, 2, 3)):
                raise UsageError(f"colors: has shape {given.shape}; it must be (3,), ({count}, 3) or ({count}, 2, 3)")
            tints = finite("colors", floats("colors", (np.repeat(given, 2, axis=0) if given.ndim == 2 else given).reshape(-1, 3), 3))
        first = np.empty(0, np.uint32) if segments is None else segments
        return self._native.add_primitives(kind, name, points.reshape(-1, 4), first, of_each, tints)

    def add_spheres(self, centers: ArrayLike, radii: ArrayLike, *, material: ArrayLike = 0, colors: ArrayLike | None = None,
                    name: str = "") -> int:
        """Adds spheres, which are traced as they are, and returns the number of their set. centers, radii: as of
        Primitives.spheres. material: a number from add_material, or one for each. colors: linear RGB that multiplies the
        albedo, (3,), or (N, 3) for each.

        Materials of primitives have no textures and no opacity. An emissive one shines, but lights are not sampled on
        primitives: use a mesh for lamps.
        """
        return self._add_primitives("spheres", sphere_rows(centers, radii), None, material, colors, name)

    def add_discs(self, centers: ArrayLike, normals: ArrayLike, radii: ArrayLike, holes: ArrayLike = 0.0, *, material: ArrayLike = 0,
                  colors: ArrayLike | None = None, name: str = "") -> int:
        """Adds discs as of Primitives.discs. material, colors: as of add_spheres."""
        return self._add_primitives("discs", disc_rows(centers, normals, radii, holes), None, material, colors, name)

    def add_cylinders(self, starts: ArrayLike, ends: ArrayLike, radii: ArrayLike, *, capped: bool = True, material: ArrayLike = 0,
                      colors: ArrayLike | None = None, name: str = "") -> int:
        """Adds cylinders as of Primitives.cylinders. material, colors: as of add_spheres; colors may be (N, 2, 3), at
        both ends."""
        return self._add_primitives("cylinders", cylinder_rows(starts, ends, radii, capped), None, material, colors, name)

    def add_curves(self, points: ArrayLike, radii: ArrayLike, segments: ArrayLike | None = None, *,
                   basis: Literal["bspline", "bezier"] = "bspline", shape: Literal["round", "flat"] = "round", material: ArrayLike = 0,
                   colors: ArrayLike | None = None, name: str = "") -> int:
        """Adds curves as of Primitives.curves. material, colors: as of add_spheres, for each segment; colors may be
        (S, 2, 3), at both ends. Their materials do not transmit light, unless they are thin-walled."""
        check_choice("shape", shape, ("round", "flat"))
        controls, first = curve_arrays(points, radii, segments, basis)
        kind = ("flat " if shape == "flat" else "") + ("curves" if basis == "bspline" else "bezier curves")
        return self._add_primitives(kind, controls, first, material, colors, name)

    @property
    def primitive_count(self) -> int:
        """The number of spheres, discs, cylinders and segments of curves."""
        return self._native.primitive_count()

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
        """The box of all placed meshes and primitives: (2, 3), lowest and highest corner."""
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

    def _warn_of_lamps(self) -> None:
        if line := self._native.warning_of_lamps():
            warnings.warn(line, stacklevel=3)

    def copy(self) -> Scene:
        return Scene._of(self._native.copy(), self._added_light)

    def __repr__(self) -> str:
        return f"<claray.Scene '{self._native.name}' of {self._native.mesh_count()} meshes, {self.triangle_count} triangles, " \
               f"{self.primitive_count} primitives>"


def load(name_or_path: str | os.PathLike[str], **choices: Any) -> Scene:
    """Loads a scene: a file (.obj, .gltf, .glb, .ply, .stl), or a built-in scene such as "cornell" (builtin_scenes()).

    choices, for glTF only: time (seconds of an animation), animation, variant, camera, scene (a name or an index).
    What a loader corrects or leaves out is reported by warnings.warn. A file whose own light shows hardly anything gets a
    studio, a pale sky or a lamp, and a file of rooms a view from inside. A renderer warns of them; queries need neither. Raises InputError, naming the file, for a damaged
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
