"""Scenes: loaded from files, built in, or put together from arrays."""

from __future__ import annotations

import copy
import os
from types import MappingProxyType
from typing import Any, Iterable, Literal, Mapping, Sequence, TypedDict, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import (NO_WORDS, as_array, check_choice, finite, floats, indices, integer, members, names_of, naming, number, path_of,
                      places, text, words)
from ._handle import Handle, warn
from ._primitives import curve_arrays, cylinder_rows, disc_rows, sphere_rows
from ._records import Camera, Light, Material, Records, Vector3, native_of, set_all
from ._textures import AnyTexture, Environment, Texture, environment_from, texture_from, texture_of
from ._transforms import rows_of
from ._typing import Unpack
from .errors import UsageError


class LoadOptions(TypedDict, total=False):
    """What load() takes of a file that holds several things; all but stroke_radius and images are for glTF.

    time: seconds of an animation; None: it is not animated. animation: which one; "all": all at once. variant: of the
    materials. camera, scene: which one. Each is a name, or an index as a text. stroke_radius: of points and lines; 0: they are left out;
    None: by the scene's size. images: False: a white texel stands for each. live: instances place all meshes, with the names of
    nodes, for a scene that is animated by loading it again at other times.
    """

    time: float | None
    animation: str
    variant: str
    camera: str
    scene: str
    stroke_radius: float | None
    images: bool
    live: bool


class MeshArrays(TypedDict):
    """A mesh of a scene: views of V vertices and T triangles. Arrays that the mesh lacks have no rows."""

    name: str
    vertices: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    uvs1: NDArray[np.float32]
    tangents: NDArray[np.float32]
    colors: NDArray[np.float32]
    materials: NDArray[np.uint32]
    mask: int


class Scene(Handle):
    """Meshes, primitives, materials, lights, sky and camera. An empty scene; load() makes one from a file."""

    __slots__ = ("_native", "_added_light")
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
        return int(getattr(self._native, f"{kind}_count")())

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

    def add_texture(self, image: AnyTexture, *, color: Literal["srgb", "linear"] = "srgb") -> int:
        """Adds an image and returns its number, for the maps of materials. image: a Texture, an array as of Texture, or the name
        of a file. color: what bytes mean: "srgb" for colours, "linear" for other maps; a Texture has its own."""
        texture = texture_of("image", image) if isinstance(image, Texture) else texture_of("image", image, color=color)
        self._native.add_texture(texture._native())
        return int(self._native.texture_count()) - 1

    def add_mesh(self, vertices: ArrayLike, triangles: ArrayLike, *, normals: ArrayLike | None = None,
                 uvs: ArrayLike | None = None, uvs1: ArrayLike | None = None, tangents: ArrayLike | None = None,
                 colors: ArrayLike | None = None, material: ArrayLike = 0, name: str = "", mask: int = 0xFFFFFFFF) -> int:
        """Adds a mesh and returns its number.

        vertices: (V, 3). triangles: (T, 3) indices of vertices. normals: (V, 3) of unit length; None: flat shading.
        uvs: (V, 2), (0, 0) is an image's top left corner. uvs1: a second set. tangents: (V, 4) of unit length, the last is 1 or -1,
        the sign of the bitangent; None: computed from uvs. colors: (V, 3) or (V, 4), linear, 0 to 1, multiply the albedo; the
        fourth multiplies the opacity. material: number from add_material, or (T,) one for each triangle. mask: for masks of rays.
        """
        points = places("vertices", vertices)
        faces = indices("triangles", triangles, 3, len(points), "vertices")
        tints = None if colors is None else as_array("colors", colors)
        if tints is not None and tints.ndim == 2 and tints.shape[1] == 3:
            tints = np.hstack([tints, np.ones((len(tints), 1), np.float32)])
        per_vertex = [_per_vertex(key, array, columns, len(points)) for key, array, columns in (
            ("normals", normals, 3), ("uvs", uvs, 2), ("uvs1", uvs1, 2), ("tangents", tangents, 4),
            ("colors", tints, 4))]
        numbers = as_array("material", material)
        if numbers.ndim == 0:
            _check_word("material", material)
            of_each = NO_WORDS if material == 0 else np.full(len(faces), numbers, np.uint32)
        else:
            of_each = words("material", numbers, len(faces))
        _check_word("mask", mask)
        if not isinstance(name, str):
            raise UsageError(f"name: is a {type(name).__name__}; use a text")
        return int(self._native.add_mesh(name, points, faces, *per_vertex, of_each, int(mask)))

    def move_vertices(self, mesh: int, vertices: ArrayLike, normals: ArrayLike | None = None) -> None:
        """Moves the vertices of a mesh, (V, 3) as before, for Renderer.update(scene, vertices=True). normals: as of add_mesh; they
        must be given if, and only if, the mesh has some."""
        shown = self._mesh("mesh", mesh)
        count = len(shown["vertices"])
        points = places("vertices", vertices)
        if len(points) != count:
            raise UsageError(f"vertices: has {len(points)} rows, but the mesh has {count}")
        if (normals is not None) != (len(shown["normals"]) != 0):
            raise UsageError("normals: must be given if, and only if, the mesh has some")
        self._native.move_vertices(mesh, points, _per_vertex("normals", normals, 3, count))

    def _mesh(self, name: str, mesh: int) -> MeshArrays:
        try:
            return cast("MeshArrays", self._native.mesh_at(mesh))
        except (IndexError, TypeError):
            raise UsageError(f"{name}: is {mesh!r}, and the scene has {self._native.mesh_count()} meshes") from None

    def add_instance(self, mesh: int, transform: ArrayLike | None = None, transform_end: ArrayLike | None = None, *,
                     name: str = "") -> int:
        """Places a mesh and returns the number of the instance. A scene without instances shows every mesh once, where its
        vertices are; with the first instance, it shows instances only.

        transform: (4, 4) or (3, 4) from the coordinates of the mesh to those of the world; None: they are the same.
        transform_end: the same at shutter close, if it moves (motion blur); the matrices in between are interpolated linearly.
        """
        self._mesh("mesh", mesh)
        begin = np.eye(4) if transform is None else as_array("transform", transform)
        rows = rows_of("transform", begin[None])
        if transform_end is not None:
            rows = np.concatenate([rows, rows_of("transform_end", as_array("transform_end", transform_end)[None])])
        return int(self._native.add_instance(mesh, rows, text("name", name)))

    def set_instances(self, meshes: ArrayLike, transforms: ArrayLike, ends: ArrayLike | None = None,
                      names: Sequence[str] = ()) -> None:
        """Replaces all instances, by any number of them. meshes: (N,) the mesh of each. transforms, ends: (N, 4, 4) or (N, 3, 4), as of
        add_instance. names: one for each, or none. Renderer.update(scene, instances=True) shows them."""
        rows = rows_of("transforms", transforms)
        numbers = as_array("meshes", meshes) if len(rows) else np.empty(0, np.uint32)
        which = indices("meshes", numbers[..., None], 1, self._native.mesh_count(), "scene.meshes")[:, 0]
        if len(which) != len(rows):
            raise UsageError(f"transforms: has {len(rows)} matrices, but meshes has {len(which)} rows")
        moved = rows[:0] if ends is None else rows_of("ends", ends)
        if ends is not None and len(moved) != len(rows):
            raise UsageError(f"ends: has {len(moved)} matrices, but there are {len(rows)} instances")
        texts = members("names", names, "texts")
        if len(texts) not in (0, len(rows)):
            raise UsageError(f"names: has {len(texts)} texts, but there are {len(rows)} instances")
        with naming("names"):
            self._native.set_instances(np.ascontiguousarray(which), rows, moved, texts)

    def _add_primitives(self, kind: str, points: NDArray[np.float32], segments: NDArray[np.uint32] | None, material: ArrayLike,
                        colors: ArrayLike | None, name: str) -> int:
        count = len(segments) if segments is not None else points.size // (4 if kind == "spheres" else 8)
        numbers = as_array("material", material)
        of_each = words("material", np.broadcast_to(numbers, (count,)) if numbers.ndim == 0 else numbers, count)
        tints = np.empty((0, 3), np.float32)
        if colors is not None:
            given = as_array("colors", colors)
            if given.shape in ((), (1,), (3,)):
                given = np.broadcast_to(given, (count, 3))
            if given.shape not in ((count, 3), (count, 2, 3)):
                raise UsageError(f"colors: has shape {given.shape}; it must be (3,), ({count}, 3) or ({count}, 2, 3)")
            tints = finite("colors", floats("colors", (np.repeat(given, 2, axis=0) if given.ndim == 2 else given).reshape(-1, 3), 3))
        first = np.empty(0, np.uint32) if segments is None else segments
        return int(self._native.add_primitives(kind, text("name", name), points.reshape(-1, 4), first, of_each, tints))

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
        return int(self._native.primitive_count())

    @property
    def meshes(self) -> tuple[MeshArrays, ...]:
        """The meshes: name, mask, and views 'vertices' (V, 3), 'triangles' (T, 3), 'normals', 'uvs', 'uvs1', 'tangents', 'colors',
        'materials'. All are read-only; add_mesh adds one, and move_vertices moves one."""
        return tuple(cast("MeshArrays", MappingProxyType(self._native.mesh_at(i))) for i in range(self._native.mesh_count()))

    @property
    def instances(self) -> Mapping[str, Any]:
        """Where meshes are: 'meshes' (N,), the mesh of each instance; 'transforms' (N, 3, 4), from its coordinates to those
        of the world; 'ends', the same at time 1, or None if nothing moves; 'names'. All are read-only: see add_instance and
        set_instances."""
        meshes, rows, ends, names = self._native.placements()
        return MappingProxyType({"meshes": _read_only(meshes), "transforms": _read_only(rows),
                                 "ends": None if (rows == ends).all() else _read_only(ends), "names": tuple(names)})

    @property
    def primitives(self) -> tuple[Mapping[str, Any], ...]:
        """The sets of primitives: kind, name, and views 'points' (P, 4), 'segments', 'materials', 'colors', read-only; add_spheres and
        others add them."""
        return tuple(MappingProxyType(self._native.primitives_at(i)) for i in range(self._native.primitives_count()))

    @property
    def textures(self) -> tuple[Texture, ...]:
        """Copies of the images, by their numbers. Setting them replaces all."""
        return tuple(texture_from(native) for native in self._native_textures())

    @textures.setter
    def textures(self, textures: Iterable[AnyTexture]) -> None:
        given = members("textures", textures, "textures")
        with naming("textures"):
            self._native.set_textures([texture_of("texture", one)._native() for one in given])

    def _native_textures(self) -> list[Any]:
        return [self._native.texture_at(i) for i in range(self._native.texture_count())]

    @property
    def triangle_count(self) -> int:
        return int(self._native.triangle_count())

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The box of all placed meshes and primitives: (2, 3), lowest and highest corner. Read-only."""
        return _read_only(np.array(self._native.bounds()))

    @property
    def name(self) -> str:
        return str(self._native.name)

    @name.setter
    def name(self, name: str) -> None:
        set_all(self._native, "Scene", {"name": name})

    @property
    def materials(self) -> Records[Material]:
        """The materials, as a list. Changes of the list and of its elements change the scene."""
        return Records(self, Material)

    @materials.setter
    def materials(self, materials: Iterable[Material]) -> None:
        self.materials.assign(materials)

    @property
    def lights(self) -> Records[Light]:
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

    def automatic_camera(self, vertical_fov: float = 40.0, aspect: float = 1.0) -> Camera:
        """A camera that sees the whole scene, from the front and slightly from above. vertical_fov: degrees. aspect: width over
        height."""
        return Camera._of(self._native.automatic_camera(number("vertical_fov", vertical_fov), number("aspect", aspect)))

    @property
    def sky(self) -> tuple[Vector3, Vector3]:
        """Radiance of rays that leave the scene: at the horizon and at the zenith, three numbers each. One colour may be
        set for both."""
        return cast("tuple[Vector3, Vector3]", self._native.sky)

    @sky.setter
    def sky(self, colors: Any) -> None:
        given = as_array("sky", colors)
        if given.dtype.kind not in "fiu" or given.shape not in ((3,), (2, 3)):
            raise UsageError(f"sky: is {colors!r}; use three numbers, or three for the horizon and three for the zenith")
        horizon, zenith = np.broadcast_to(given, (2, 3)).tolist()
        self._native.sky = (tuple(horizon), tuple(zenith))
        self._added_light = None

    @property
    def fog(self) -> tuple[float, Vector3, float]:
        """Density, colour and depth of the fog between surfaces. After a distance d, exp(-density d) of the light is left,
        and the rest has the colour. Fog of the depth lies before the sky, an environment and far lights. Density 0: no fog."""
        return cast("tuple[float, Vector3, float]", self._native.fog)

    @fog.setter
    def fog(self, fog: Any) -> None:
        try:
            density, color, depth = fog
            red, green, blue = color
            self._native.fog = (float(density), (float(red), float(green), float(blue)), float(depth))
        except (TypeError, ValueError) as error:
            raise UsageError(f"fog: is {fog!r}; use a density, three numbers for the colour, and a depth") from error

    @property
    def environment(self) -> Environment | None:
        """The image around the scene, which takes the place of the sky; None: there is none."""
        return environment_from(self._native.environment)

    @environment.setter
    def environment(self, environment: Environment | AnyTexture | None) -> None:
        """environment: an Environment; an image in latitude and longitude as of Environment; or None."""
        if environment is None:
            self._native.environment = _native.NativeEnvironment()
        else:
            given = environment if isinstance(environment, Environment) else Environment(texture_of("environment", environment))
            self._native.environment = given._native()
        self._added_light = None

    def validate(self) -> None:
        """Raises InputError, naming the object and the value, for what a renderer would refuse."""
        self._native.validate()

    def effects(self) -> dict[str, str]:
        """The effects that the scene uses, by their names, and the objects that use them: {"glass": "the material 'ball'"}."""
        def told(row: Mapping[str, Any]) -> str:
            return row["first"] if row["count"] < 2 else f"{row['first']} and {row['count'] - 1} more"
        self.validate()
        return {row["effect"]: told(row) for row in _native.causes_of_effects(self._native)}

    def without_effects(self, effects: str | Sequence[str]) -> Scene:
        """The scene without some effects, such as "textures": a material of a removed kind becomes Lambert's, a lens a pinhole."""
        names = names_of("effects", effects)
        self.validate()
        with naming("effects"):
            return Scene._of(self._native.without_effects(names), self._added_light)

    def set_culling(self, culling: Literal["by-file", "back", "none"]) -> None:
        """Which sides of surfaces rays hit: "back" passes through the backs of all materials but solid glass, "none" through none."""
        check_choice("culling", culling, ("by-file", "back", "none"))
        self._native.set_culling(culling)

    def flip_fronts(self) -> None:
        """Exchanges the fronts and the backs of all triangles."""
        self._native.flip_fronts()

    def use_light_map(self, mesh: int, light_map: AnyTexture, uv_set: Literal[0, 1] = 1) -> None:
        """Gives a baked light map to the Lambertian materials of a mesh, which are copied before. See bake_light_map."""
        self._mesh("mesh", mesh)
        _native.use_light_map(self._native, mesh, texture_of("light_map", light_map)._native(), integer("uv_set", uv_set, 0, 1))

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

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Pickled are the arrays and the values."""
        return _restored, ({
            "name": self.name,
            "meshes": [_plain(mesh) for mesh in self.meshes],
            "instances": _plain(self.instances) if self._native.has_instances() else None,
            "primitives": [_plain(one) for one in self.primitives],
            "materials": [copy.copy(one) for one in self.materials],
            "textures": self.textures,
            "lights": [copy.copy(one) for one in self.lights],
            "sky": self.sky,
            "fog": self.fog,
            "environment": self.environment,
            "camera": copy.copy(self.camera) if self._native.has_camera() else None,
            "added_light": self._added_light,
        },)

    def __repr__(self) -> str:
        return f"<claray.Scene '{self._native.name}' of {self._native.mesh_count()} meshes, {self.triangle_count} triangles, " \
               f"{self.primitive_count} primitives>"


def _append(records: Records[Any], name: str, record: Any, properties: dict[str, Any]) -> int:
    if record is not None and properties:
        raise UsageError(f"{name}: is given, and so is {next(iter(properties))}; use one of both")
    records.append(records._of(**properties) if record is None else record)
    return len(records) - 1


def _plain(values: Mapping[str, object]) -> dict[str, Any]:
    copies: dict[str, Any] = dict(values)
    for key, value in copies.items():
        if isinstance(value, np.ndarray):
            copies[key] = np.array(value)  # pyright: ignore[reportUnknownArgumentType]  # of any type of numbers
    return copies


def _restored(state: Mapping[str, Any]) -> Scene:
    scene = Scene()
    for mesh in state["meshes"]:
        scene._native.add_mesh(*(mesh[key] for key in ("name", "vertices", "triangles", "normals", "uvs", "uvs1", "tangents", "colors",
                                                       "materials", "mask")))
    for one in state["primitives"]:
        scene._native.add_primitives(*(one[key] for key in ("kind", "name", "points", "segments", "materials", "colors")))
    if (placed := state["instances"]) is not None:
        scene.set_instances(placed["meshes"], placed["transforms"], placed["ends"], placed["names"])
    for key in ("name", "materials", "textures", "lights", "sky", "fog", "environment"):
        setattr(scene, key, state[key])
    if state["camera"] is not None:
        scene.camera = state["camera"]
    scene._added_light = state["added_light"]
    return scene


def _per_vertex(name: str, value: Any, columns: int, count: int) -> NDArray[np.float32]:
    """(count, columns), or no rows for None."""
    if value is None:
        return np.empty((0, columns), np.float32)
    rows = finite(name, floats(name, value, columns))
    if len(rows) not in (0, count):
        raise UsageError(f"{name}: has {len(rows)} rows, but vertices has {count}")
    return rows


def _check_word(name: str, value: Any) -> None:
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or not 0 <= value < 2**32:
        raise UsageError(f"{name}: is {value!r}; use a number from 0 to 2**32 - 1")


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    """An array whose elements cannot be set, which would not change the scene."""
    array.flags.writeable = False
    return array


def load(name_or_path: str | os.PathLike[str], **choices: Unpack[LoadOptions]) -> Scene:
    """Loads a scene: a file (docs/formats.md), or a built-in scene such as "cornell" (builtin_scenes()).

    choices: as of LoadOptions.
    What a loader corrects or leaves out is reported by warnings.warn. A file whose own light shows hardly anything gets a
    studio, a pale sky or a lamp, and a file of rooms a view from inside. A renderer warns of them; queries need neither.
    Raises InputError, naming the file, for a damaged one, and UsageError for an unknown scene or choice.
    """
    options = set_all(_native.NativeLoadOptions(), "load", {**choices})
    path = path_of("name_or_path", name_or_path)
    with naming("name_or_path"):
        native, messages, added_light = _native.load(path, options)
    for message in messages:
        warn(message)
    return Scene._of(native, added_light)


def animation_seconds(name_or_path: str | os.PathLike[str], **choices: Unpack[LoadOptions]) -> float | None:
    """The duration of the animation that load(name_or_path, **choices) takes; None if there is none."""
    path, options = path_of("name_or_path", name_or_path), set_all(_native.NativeLoadOptions(), "animation_seconds", {**choices})
    with naming("name_or_path"):
        return _native.animation_seconds(path, options)


def builtin_scenes() -> list[str]:
    """The names of the built-in scenes."""
    return _native.builtin_scene_names()
