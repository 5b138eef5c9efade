"""Materials, lights and cameras: values of their own, or those in a scene."""

from __future__ import annotations

import copy
import operator
from collections.abc import Iterable, MutableSequence
from typing import TYPE_CHECKING, Any, Generic, Literal, Sequence, TypeVar, Union, cast, overload

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import did_you_mean, members, naming, number
from ._handle import Handle
from ._typing import dataclass_transform
from ._values import TextureUse
from .errors import UsageError

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._scene import Scene

MaterialKind = Literal["lambert", "mirror", "glass", "metal", "blinn-phong", "principled", "unlit", "oren-nayar", "custom"]
LightKind = Literal["point", "spot", "directional", "sun"]
Projection = Literal["perspective", "orthographic", "panorama", "cube", "fisheye", "equisolid"]
AlphaMode = Literal["opaque", "mask", "blend"]
AlphaTest = Literal[">=", ">", "<", "<=", "==", "!="]
MaterialRole = Literal["surface", "holdout", "shadow-catcher"]
Stereo = Literal["none", "side-by-side", "top-bottom"]
Numbers = Union[Sequence[float], NDArray[Any]]
Vector2 = tuple[float, float]
Vector3 = tuple[float, float, float]
Read = TypeVar("Read")
Write = TypeVar("Write")


def set_all(native: Any, name: str, values: dict[str, Any]) -> Any:
    for key, value in values.items():
        if not hasattr(native, key) or key.startswith("_") or callable(getattr(native, key)):
            raise UsageError(f"{name}: has no property '{key}'{did_you_mean(key, dir(native))}")
        current = getattr(native, key)
        if isinstance(value, str) != isinstance(current, str):  # float("1") is a number, too
            raise UsageError(f"{key}: {value!r} does not fit a {name}")
        if isinstance(value, np.ndarray):
            value = cast("NDArray[Any]", value).tolist()
        try:
            setattr(native, key, value)
        except (TypeError, OverflowError):
            raise UsageError(f"{key}: {value!r} does not fit a {name}") from None
    return native


class Property(Generic[Read, Write]):
    """A property of a record, which is found in the native one."""

    def __init__(self, doc: str = "") -> None:
        self.__doc__ = doc

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, record: None, owner: type) -> Self: ...
    @overload
    def __get__(self, record: Any, owner: type) -> Read: ...
    def __get__(self, record: Any, owner: type) -> Any:
        return self if record is None else self.read(record)

    def read(self, record: Record) -> Any:
        return getattr(record._native(), self.name)

    def __set__(self, record: Any, value: Write) -> None:
        record._set(self.name, value)


class MapProperty(Property["TextureUse | None", "TextureUse | int | None"]):
    """A use of a texture; a number is that of the texture, None is no map."""

    def read(self, record: Record) -> TextureUse | None:
        members = super().read(record)
        return None if members is None else TextureUse(*members)


Number = Property[float, float]
Flag = Property[bool, bool]
Text = Property[str, str]
Two = Property[Vector2, Numbers]
Three = Property[Vector3, Numbers]


def _first(doc: str, *, default: Any = None, kw_only: Literal[False] = False) -> Any:
    """A property that may be given without its name; type checkers read the other parameters."""
    return Property[Any, Any](doc)


@dataclass_transform(kw_only_default=True, field_specifiers=(_first,))
class Record(Handle):
    """Values with names. One in a scene is found there at each use, so that setting a property changes the scene."""

    __slots__ = ("_own", "_scene", "_index")
    _own: Any  # None if it is in a scene
    _scene: Scene | None
    _index: int | None  # in the scene's list; None: of the camera
    _kind: str  # as the functions of NativeScene have it
    _make: Any  # the native class

    if not TYPE_CHECKING:  # type checkers take the parameters from the properties of the class
        def __init__(self, *kind: str, **properties: Any) -> None:
            if kind:
                names = self._positional()
                if len(kind) > len(names):
                    raise TypeError(f"{type(self).__name__}() takes {len(names)} positional arguments, but {len(kind)} were given")
                properties = {**dict(zip(names, kind)), **properties}
            self._own, self._scene, self._index = set_all(self._make(), type(self).__name__, properties), None, None

    @classmethod
    def _positional(cls) -> tuple[str, ...]:
        return ("kind",) if "kind" in cls._properties() else ()

    @classmethod
    def _properties(cls) -> list[str]:
        return [name for name, value in vars(cls).items() if isinstance(value, Property)]

    @classmethod
    def _in(cls, scene: Scene, index: int | None = None) -> Self:
        record = cls.__new__(cls)
        record._own, record._scene, record._index = None, scene, index
        return record

    @classmethod
    def _of(cls, native: Any) -> Self:
        record = cls.__new__(cls)
        record._own, record._scene, record._index = native, None, None
        return record

    def _native(self) -> Any:
        """A copy, unless the record is its own."""
        return self._own if self._scene is None else self._scene._read(self._kind, self._index)

    def _set(self, name: str, value: Any) -> None:
        native = set_all(self._native(), type(self).__name__, {name: value})
        if self._scene is not None:
            self._scene._write(self._kind, self._index, native)

    def __eq__(self, other: Any) -> bool:
        """Whether both are the same one, not whether their values are."""
        return (isinstance(other, Record) and self._own is other._own and self._scene is other._scene
                and (type(self), self._index) == (type(other), other._index))

    def __hash__(self) -> int:
        return hash((type(self), id(self._own), id(self._scene), self._index))

    def __copy__(self) -> Self:
        return self._of(self._native().copy())

    def __deepcopy__(self, memo: Any) -> Self:
        return self.__copy__()

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Pickled are the values, so that what is unpickled is in no scene."""
        native = self._native()
        return _made, (type(self), {name: getattr(native, name) for name in self._properties()})

    def __repr__(self) -> str:
        native, plain = self._native(), self._make()
        shown = [f"{n}={_text(getattr(native, n))}" for n in sorted(self._properties(), key=lambda n: (n not in ("kind", "name"), n))
                 if n == "kind" or getattr(native, n) != getattr(plain, n)]
        return f"claray.{type(self).__name__}({', '.join(shown)})"


def _made(of: type[Record], values: dict[str, Any]) -> Record:
    return of._of(set_all(of._make(), of.__name__, values))


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        values: tuple[Any, ...] = value  # pyright: ignore[reportUnknownVariableType]  # of anything
        return "(" + ", ".join(map(_text, values)) + ")"
    return f"{value:.7g}" if isinstance(value, float) else repr(value)


def native_of(name: str, value: Any, kind: type[Record]) -> Any:
    if not isinstance(value, kind):
        raise UsageError(f"{name}: is a {type(value).__name__}; use a claray.{kind.__name__}")
    return value._native()


class Material(Record):
    """A material: docs/effects.md describes the kinds and what each property does.

    Colours are linear Rec. 709, three numbers each; emission is radiance in W / (m^2 sr). A map is None, the number of a texture
    (Scene.add_texture) or a TextureUse, and multiplies its value. All can be read and set later. Raises UsageError for other
    names and values that do not fit.
    """

    __slots__ = ()
    _kind, _make = "material", _native.NativeMaterial

    kind: Property[MaterialKind, MaterialKind] = _first("what it is", default=None, kw_only=False)
    name: Text = Property()
    albedo: Three = Property("diffuse albedo; mirror, metal: reflectance; glass: tint; principled: base colour")
    emission: Three = Property("radiance of both sides, W / (m^2 sr)")
    roughness: Number = Property("0 to 1: metal, glass, principled, oren-nayar")
    ior: Number = Property("index of refraction: glass, principled")
    metallic: Number = Property("principled: 0 is a dielectric, 1 a metal")
    transmission: Number = Property("principled: share of the dielectric's base that refracts")
    thin_walled: Flag = Property("glass, principled: a thin wall without refraction")
    clearcoat: Number = Property("principled: share of a coat of index 1.5")
    clearcoat_roughness: Number = Property("0 to 1")
    specular: Three = Property("blinn-phong: colour of the highlight")
    specular_weight: Number = Property("0 to 1: strength of the dielectric's reflection (KHR_materials_specular)")
    specular_tint: Three = Property("multiplies its reflectance at normal incidence")
    sheen: Three = Property("colour of fibres (KHR_materials_sheen)")
    sheen_roughness: Number = Property("0 to 1")
    anisotropy: Number = Property("0 to 1: stretches highlights (KHR_materials_anisotropy)")
    anisotropy_rotation: Number = Property("radians from the tangent")
    iridescence: Number = Property("0 to 1: share of a thin film (KHR_materials_iridescence)")
    iridescence_ior: Number = Property("index of refraction of the film")
    film_thickness: Two = Property("nanometres, where its map is 0 and where it is 1 or absent")
    attenuation: Three = Property("what is left of white light after attenuation_distance")
    attenuation_distance: Number = Property("0: no absorption")
    opacity: Number = Property("0 to 1, as alpha_mode uses it")
    alpha_mode: Property[AlphaMode, AlphaMode] = Property("how the opacity is used (glTF)")
    alpha_cutoff: Number = Property("of masks")
    alpha_test: Property[AlphaTest, AlphaTest] = Property("opacity ... alpha_cutoff; glTF: >=")
    cull_back: Flag = Property("rays pass through the back")
    role: Property[MaterialRole, MaterialRole] = Property("what it shows in images with alpha")
    albedo_map: MapProperty = MapProperty("RGB; its alpha multiplies the opacity")
    emission_map: MapProperty = MapProperty("RGB")
    metallic_roughness_map: MapProperty = MapProperty("green: roughness, blue: metallic")
    transmission_map: MapProperty = MapProperty("red")
    clearcoat_map: MapProperty = MapProperty("red")
    clearcoat_roughness_map: MapProperty = MapProperty("green")
    clearcoat_normal_map: MapProperty = MapProperty("as normal_map")
    clearcoat_normal_scale: Number = Property()
    specular_map: MapProperty = MapProperty("RGB: specular_tint; blinn-phong: specular")
    specular_weight_map: MapProperty = MapProperty("alpha")
    shininess_map: MapProperty = MapProperty("red")
    sheen_map: MapProperty = MapProperty("RGB")
    sheen_roughness_map: MapProperty = MapProperty("alpha")
    anisotropy_map: MapProperty = MapProperty("red, green: direction, 0.5 is 0; blue: strength")
    iridescence_map: MapProperty = MapProperty("red")
    film_thickness_map: MapProperty = MapProperty("green")
    opacity_map: MapProperty = MapProperty("red")
    normal_map: MapProperty = MapProperty("tangent space, 0.5 is 0; +y is up in the image")
    normal_scale: Number = Property()
    height_map: MapProperty = MapProperty("red, times height_scale in units of the scene; changes the normal only")
    height_scale: Number = Property()
    light_map: MapProperty = MapProperty("RGB irradiance in place of light from elsewhere")
    custom: Property[int, int] = Property("kind custom: the number of the BSDF, from add_bsdf")
    parameters: Property["list[float]", Numbers] = Property("kind custom: the numbers that the BSDF reads")
    shininess: Number = Property("blinn-phong: exponent of the highlight")


class Light(Record):
    """A light; docs/effects.md describes the kinds. Errors as of Material."""

    __slots__ = ()
    _kind, _make = "light", _native.NativeLight

    kind: Property[LightKind, LightKind] = _first("what it is", default=None, kw_only=False)
    name: Text = Property()
    position: Three = Property()
    direction: Three = Property("in which it shines; not for points")
    intensity: Three = Property("W / sr; far lights: irradiance of a surface that faces it, W / m^2")
    inner_angle: Number = Property("near cones: radians from the axis, up to which it shines fully")
    outer_angle: Number = Property("cones: radians from the axis, beyond which it does not shine")
    range: Number = Property("beyond which it fades to nothing; 0: none")
    attenuation: Three = Property("a0, a1, a2: intensity / (a0 + a1 d + a2 d^2) at distance d; physical: 0, 0, 1")
    linear_range: Flag = Property("the range ends as 1 - d / range")


class Camera(Record):
    """A camera. Errors as of Material."""

    __slots__ = ()
    _kind, _make = "camera", _native.NativeCamera

    position: Three = Property()
    target: Three = Property()
    up: Three = Property()
    vertical_fov: Number = Property("degrees, of a perspective camera or a fisheye")
    aperture_radius: Number = Property("of a thin lens; 0: a pinhole")
    focus_distance: Number = Property("of the sharp plane along the view; 0: that of the target")
    position_end: Property["Vector3 | None", "Numbers | None"] = Property("at shutter close, if the camera moves")
    target_end: Property["Vector3 | None", "Numbers | None"] = Property("at shutter close, if it moves")
    projection: Property[Projection, Projection] = Property()
    orthographic_height: Number = Property("of the image; setting it makes rays parallel")
    shift: Two = Property("of a perspective lens, in parts of the image's width and height")
    tilt: Two = Property("degrees by which the sharp plane is turned: its top goes away, its right goes away")
    stereo: Property[Stereo, Stereo] = Property("the images of two eyes in one")
    eye_distance: Number = Property("between the eyes, in units of the scene")

    def _set(self, name: str, value: Any) -> None:
        super()._set(name, value)
        if name == "orthographic_height":
            super()._set("projection", "orthographic")

    if not TYPE_CHECKING:
        def __init__(self, **properties: Any) -> None:
            if "orthographic_height" in properties:
                properties = {"projection": "orthographic", **properties}
            super().__init__(**properties)

    def orbited(self, degrees: float) -> Camera:
        """A camera turned round the axis through its target along `up`, counter-clockwise seen from above."""
        return Camera._of(self._native().orbited(number("degrees", degrees)))


R = TypeVar("R", bound=Record)


class Records(MutableSequence[R]):
    """The materials or the lights of a scene, as a list that changes the scene."""

    __slots__ = ("_scene", "_of")

    def __init__(self, scene: Scene, of: type[R]) -> None:
        self._scene, self._of = scene, of

    def __len__(self) -> int:
        return self._scene._count(self._of._kind)

    @overload
    def __getitem__(self, index: int) -> R: ...
    @overload
    def __getitem__(self, index: slice) -> list[R]: ...
    def __getitem__(self, index: int | slice) -> R | list[R]:
        if isinstance(index, slice):
            return [self._of._in(self._scene, i) for i in range(len(self))[index]]
        number, count = operator.index(index), len(self)
        if not -count <= number < count:
            raise IndexError(f"{self._of._kind}: has {count}, not a number {number}")
        return self._of._in(self._scene, number % count)

    def _natives(self) -> list[Any]:
        return [record._native() for record in self]

    @overload
    def __setitem__(self, index: int, value: R) -> None: ...
    @overload
    def __setitem__(self, index: slice, value: Iterable[R]) -> None: ...
    def __setitem__(self, index: int | slice, value: R | Iterable[R]) -> None:
        natives, name = self._natives(), self._of._kind
        if isinstance(index, slice):
            natives[index] = [native_of(name, one, self._of) for one in cast("Iterable[R]", value)]
        else:
            natives[index] = native_of(name, value, self._of)
        self._scene._replace(name, natives)

    def __delitem__(self, index: int | slice) -> None:
        natives = self._natives()
        del natives[index]
        self._scene._replace(self._of._kind, natives)

    def insert(self, index: int, value: R) -> None:
        natives = self._natives()
        natives.insert(index, native_of(self._of._kind, value, self._of))
        self._scene._replace(self._of._kind, natives)

    def pop(self, index: int = -1) -> R:
        record = copy.copy(self[index])
        del self[index]
        return record

    def reverse(self) -> None:
        self[:] = self[::-1]

    def assign(self, values: Iterable[R]) -> None:
        name, of_what = f"{self._of._kind}s", f"claray.{self._of.__name__}"
        if isinstance(values, Record):
            raise UsageError(f"{name}: is a {type(values).__name__}; use a list of {of_what}")
        given = members(name, values, of_what)
        with naming(name):
            self[:] = given

    def __repr__(self) -> str:
        return repr(list(self))


def add_bsdf(name: str, source: str, parameters: int = 0) -> int:
    """Adds a BSDF that reflects, and returns its number for Material(kind="custom", custom=number, parameters=...).

    name: a C identifier. source: OpenCL C that defines sample_NAME, eval_NAME and is_delta_NAME as kernels/bsdf/types.clh
    describes. parameters: the count of numbers that it reads by parameters_of(material, view). It holds for this process, and for
    renderers that are made later. Raises UsageError for a name that is no identifier or in use.
    """
    for key, value in (("name", name), ("source", source)):
        if not isinstance(value, str) or not value.strip():
            raise UsageError(f"{key}: is {value!r}; use a text")
    if not isinstance(parameters, (int, np.integer)) or not 0 <= parameters < 2**32:
        raise UsageError(f"parameters: is {parameters!r}; use a count of numbers")
    return _native.add_bsdf(name, source, int(parameters))
