"""Scenes: loaded from files, built in, or put together from arrays."""

from __future__ import annotations

import os
from types import MappingProxyType
from typing import Any, Iterable, Literal, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import as_array, check_choice, finite, floats, indices, places, words
from ._handle import Handle, warn
from ._primitives import curve_arrays, cylinder_rows, disc_rows, sphere_rows
from ._records import Camera, Light, Material, Records, native_of, set_all
from .errors import UsageError


class Scene(Handle):
    """Meshes, primitives, materials, lights, sky and camera. An empty scene; load() makes one from a file."""

    __slots__ = ("_native", "_added_light")
    _instead_of_pickling = "copy() copies it; pass the name of its file, or its arrays, to other processes"
    _native: Any
    _added_light: str | None

    def __init__(self) -> None:
        self._native = _native.NativeScene()
        self._added_light = None

    @classmethod
    def _of(cls, native: Any, added_light: str | None = None) -> Scene:
        scene = cls.__new__(cls)
        scene._native = native
        scene._added_light = added_light
        return scene

    def _count(self, kind: str) -> int:
        return getattr(self._native, f"{kind}_count")()

    def _read(self, kind: str, index: int | None) -> Any:
        """A copy of a material, a light or the camera."""
        if index is None:
            return self._native.camera
        try:
            return getattr(self._native, f"{kind}_at")(index)
        except IndexError:
            raise UsageError(f"{kind}: the scene has no {kind} {index} any more; take it from scene.{kind}s again") from None

    def _write(self, kind: str, index: int | None, native: Any) -> None:
        if index is None:
            self._native.camera = native
        else:
            getattr(self._native, f"set_{kind}")(index, native)
        self._note_change(kind)

    def _replace(self, kind: str, natives: list[Any]) -> None:
        getattr(self._native, f"set_{kind}s")(natives)
        self._note_change(kind)

    def _note_change(self, kind: str) -> None:
        if kind == "light":
            self._added_light = None

    def add_material(self, material: Material | None = None, **properties: Any) -> int:
        """Adds a copy of a Material, or one of these properties, and returns its number."""
        return _append(self.materials, "material", material, properties)

    def add_light(self, light: Light | None = None, **properties: Any) -> int:
        """Adds a copy of a Light, or one of these properties, and returns its number."""
        return _append(self.lights, "light", light, properties)

    def add_mesh(self, vertices: ArrayLike, triangles: ArrayLike, *, normals: ArrayLike | None = None,
                 uvs: ArrayLike | None = None, material: int = 0, name: str = "", mask: int = 0xFFFFFFFF) -> int:
        """Adds a mesh and returns its number.

        vertices: (V, 3). triangles: (T, 3) indices of vertices. normals: (V, 3) of unit length; None: flat shading.
        uvs: (V, 2), (0, 0) is an image's top left corner. material: number from add_material. mask: for masks of rays.
        """
        points = places("vertices", vertices)
        faces = indices("triangles", triangles, 3, len(points), "vertices")
        directions = finite("normals", floats("normals", [] if normals is None else normals, 3)) if normals is not None else np.empty((0, 3), np.float32)
        coordinates = finite("uvs", floats("uvs", uvs, 2)) if uvs is not None else np.empty((0, 2), np.float32)
        for key, array in (("normals", directions), ("uvs", coordinates)):
            if len(array) not in (0, len(points)):
                raise UsageError(f"{key}: has {len(array)} rows, but vertices has {len(points)}")
        for key, number in (("material", material), ("mask", mask)):
            if not isinstance(number, (int, np.integer)) or isinstance(number, bool) or not 0 <= number < 2**32:
                raise UsageError(f"{key}: is {number!r}; use a number from 0 to 2**32 - 1")
        if not isinstance(name, str):
            raise UsageError(f"name: is a {type(name).__name__}; use a text")
        return self._native.add_mesh(name, points, faces, directions, coordinates, material, mask)

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
    def meshes(self) -> tuple[Mapping[str, Any], ...]:
        """The meshes: name, and views 'vertices' (V, 3), 'triangles' (T, 3), 'normals', 'uvs', 'materials'. All are
        read-only; add_mesh adds one."""
        return tuple(MappingProxyType(self._native.mesh_at(i)) for i in range(self._native.mesh_count()))

    @property
    def instances(self) -> Mapping[str, Any]:
        """Where meshes are: 'meshes' (N,), the mesh of each instance; 'transforms' (N, 3, 4), from its coordinates to those
        of the world; 'ends', the same at time 1, or None if nothing moves. All are read-only."""
        meshes, begin, end = self._native.placements()
        rows = _read_only(np.array(begin, np.float32).reshape(-1, 3, 4))
        ends = _read_only(np.array(end, np.float32).reshape(-1, 3, 4))
        return MappingProxyType({"meshes": _read_only(np.array(meshes, np.uint32)), "transforms": rows,
                                 "ends": None if (rows == ends).all() else ends})

    @property
    def triangle_count(self) -> int:
        return self._native.triangle_count()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The box of all placed meshes and primitives: (2, 3), lowest and highest corner. Read-only."""
        return _read_only(np.array(self._native.bounds()))

    @property
    def name(self) -> str:
        return self._native.name

    @name.setter
    def name(self, name: str) -> None:
        set_all(self._native, "Scene", {"name": name})

    @property
    def materials(self) -> Records:
        """The materials, as a list. Changes of the list and of its elements change the scene."""
        return Records(self, Material)

    @materials.setter
    def materials(self, materials: Iterable[Material]) -> None:
        self.materials.assign(materials)

    @property
    def lights(self) -> Records:
        """The lights, as a list. Changes of the list and of its elements change the scene."""
        return Records(self, Light)

    @lights.setter
    def lights(self, lights: Iterable[Light]) -> None:
        self.lights.assign(lights)

    @property
    def camera(self) -> Camera:
        """The camera, or one that sees the whole scene. Setting one of its properties, or a Camera, changes the scene."""
        return Camera._in(self)

    @camera.setter
    def camera(self, camera: Camera) -> None:
        self._native.camera = native_of("camera", camera, Camera)

    @property
    def sky(self) -> tuple[Any, Any]:
        """Radiance of rays that leave the scene: at the horizon and at the zenith, three numbers each. One colour may be
        set for both."""
        return self._native.sky

    @sky.setter
    def sky(self, colors: Any) -> None:
        given = as_array("sky", colors)
        if given.dtype.kind not in "fiu" or given.shape not in ((3,), (2, 3)):
            raise UsageError(f"sky: is {colors!r}; use three numbers, or three for the horizon and three for the zenith")
        horizon, zenith = np.broadcast_to(given, (2, 3)).tolist()
        self._native.sky = (tuple(horizon), tuple(zenith))
        self._added_light = None

    @property
    def fog(self) -> tuple[float, Any, float]:
        """Density, colour and depth of the fog between surfaces. After a distance d, exp(-density d) of the light is left,
        and the rest has the colour. Fog of the depth lies before the sky, an environment and far lights. Density 0: no fog."""
        return self._native.fog

    @fog.setter
    def fog(self, fog: Any) -> None:
        try:
            density, color, depth = fog
            red, green, blue = color
            self._native.fog = (float(density), (float(red), float(green), float(blue)), float(depth))
        except (TypeError, ValueError) as error:
            raise UsageError(f"fog: is {fog!r}; use a density, three numbers for the colour, and a depth") from error

    def _warn_of_added_light(self) -> None:
        """Warns, once, of light that load() added and the caller has not replaced."""
        if self._added_light:
            warn(self._added_light + "; choose other light by Scene.sky or Scene.add_light")
        self._added_light = None

    def _warn_of_lamps(self) -> None:
        if line := self._native.warning_of_lamps():
            warn(line)

    def copy(self) -> Scene:
        return Scene._of(self._native.copy(), self._added_light)

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Scene:
        return self.copy()

    def __repr__(self) -> str:
        return f"<claray.Scene '{self._native.name}' of {self._native.mesh_count()} meshes, {self.triangle_count} triangles, " \
               f"{self.primitive_count} primitives>"


def _append(records: Records, name: str, record: Any, properties: dict[str, Any]) -> int:
    if record is not None and properties:
        raise UsageError(f"{name}: is given, and so is {next(iter(properties))}; use one of both")
    records.append(records._of(**properties) if record is None else record)
    return len(records) - 1


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    """An array whose elements cannot be set, which would not change the scene."""
    array.flags.writeable = False
    return array


def load(name_or_path: str | os.PathLike[str], **choices: Any) -> Scene:
    """Loads a scene: a file (.obj, .gltf, .glb, .ply, .stl), or a built-in scene such as "cornell" (builtin_scenes()).

    choices, for glTF only: time (seconds of an animation), animation, variant, camera, scene (a name or an index).
    What a loader corrects or leaves out is reported by warnings.warn. A file whose own light shows hardly anything gets a
    studio, a pale sky or a lamp, and a file of rooms a view from inside. A renderer warns of them; queries need neither. Raises InputError, naming the file, for a damaged
    one, and UsageError for an unknown scene or choice.
    """
    options = set_all(_native.NativeLoadOptions(), "load", choices)
    native, messages, added_light = _native.load(os.fspath(name_or_path), options)
    for message in messages:
        warn(message)
    return Scene._of(native, added_light)


def builtin_scenes() -> list[str]:
    """The names of the built-in scenes."""
    return _native.builtin_scene_names()
