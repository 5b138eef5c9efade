"""Materials, lights and cameras: values of their own, or those in a scene."""

from __future__ import annotations

import copy
import operator
from collections.abc import Iterable, MutableSequence
from typing import TYPE_CHECKING, Any

from . import _native
from ._handle import Handle
from .errors import UsageError

if TYPE_CHECKING:
    from ._scene import Scene


def set_all(native: Any, name: str, values: dict[str, Any]) -> Any:
    for key, value in values.items():
        if not hasattr(native, key) or key.startswith("_") or callable(getattr(native, key)):
            raise UsageError(f"{name}: has no property '{key}'")
        if isinstance(value, str) != isinstance(getattr(native, key), str):  # float("1") is a number, too
            raise UsageError(f"{key}: {value!r} does not fit a {name}")
        try:
            setattr(native, key, value)
        except (TypeError, OverflowError):
            raise UsageError(f"{key}: {value!r} does not fit a {name}") from None
    return native


def _property(name: str) -> property:
    def get(record: Record) -> Any:
        return getattr(record._native(), name)

    def put(record: Record, value: Any) -> None:
        native = set_all(record._native(), type(record).__name__, {name: value})
        if record._scene is not None:
            record._scene._write(record._kind, record._index, native)

    return property(get, put)


class Record(Handle):
    """Values with names. One in a scene is found there at each use, so that setting a property changes the scene."""

    __slots__ = ("_own", "_scene", "_index")
    _instead_of_pickling = "copy.copy() copies it; pass its properties to other processes"
    _own: Any  # None if it is in a scene
    _scene: Scene | None
    _index: int | None  # in the scene's list; None: of the camera
    _kind: str  # as the functions of NativeScene have it
    _make: Any  # the native class

    def __init__(self, **properties: Any) -> None:
        self._own, self._scene, self._index = set_all(self._make(), type(self).__name__, properties), None, None

    def __init_subclass__(cls) -> None:
        example = cls._make()
        for name in sorted(n for n in dir(cls._make) if not n.startswith("_") and not callable(getattr(example, n))):
            setattr(cls, name, _property(name))

    if TYPE_CHECKING:
        def __getattr__(self, name: str) -> Any: ...

    @classmethod
    def _in(cls, scene: Scene, index: int | None = None) -> Any:
        record = cls.__new__(cls)
        record._own, record._scene, record._index = None, scene, index
        return record

    def _native(self) -> Any:
        """A copy, unless the record is its own."""
        return self._own if self._scene is None else self._scene._read(self._kind, self._index)

    def __eq__(self, other: Any) -> bool:
        """Whether both are the same one, not whether their values are."""
        return (isinstance(other, Record) and self._own is other._own and self._scene is other._scene
                and (type(self), self._index) == (type(other), other._index))

    def __hash__(self) -> int:
        return hash((type(self), id(self._own), id(self._scene), self._index))

    def __copy__(self) -> Any:
        record = type(self)()
        record._own = self._native().copy()
        return record

    def __deepcopy__(self, memo: Any) -> Any:
        return self.__copy__()

    def __repr__(self) -> str:
        native, plain = self._native(), self._make()
        names = [n for n in dir(type(self)) if isinstance(getattr(type(self), n), property)]
        shown = [f"{n}={_text(getattr(native, n))}" for n in sorted(names, key=lambda n: (n not in ("kind", "name"), n))
                 if n == "kind" or getattr(native, n) != getattr(plain, n)]
        return f"claray.{type(self).__name__}({', '.join(shown)})"


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_text, value)) + ")"
    return f"{value:.7g}" if isinstance(value, float) else repr(value)


def native_of(name: str, value: Any, kind: type[Record]) -> Any:
    if not isinstance(value, kind):
        raise UsageError(f"{name}: is a {type(value).__name__}; use a claray.{kind.__name__}")
    return value._native()


class Material(Record):
    """A material: kind is "lambert", "mirror", "glass", "metal", "blinn-phong", "principled" or "unlit".

    properties: albedo, emission, specular, sheen (three numbers each, linear Rec. 709; emission is radiance in
    W / (m^2 sr)); roughness, ior, metallic, transmission, clearcoat, clearcoat_roughness, sheen_roughness, anisotropy,
    opacity, shininess (numbers); thin_walled, cull_back (bool); name. All can be read and set later. Raises UsageError for
    other names and values that do not fit.
    """

    __slots__ = ()
    _kind, _make = "material", _native.NativeMaterial

    def __init__(self, kind: str = "lambert", **properties: Any) -> None:
        super().__init__(kind=kind, **properties)


class Light(Record):
    """A light: kind is "point", "spot", "directional" or "sun".

    properties: position, direction, intensity (three numbers each; W / sr, or W / m^2 for far lights), inner_angle,
    outer_angle (radians), range (0: none), name. Errors as of Material.
    """

    __slots__ = ()
    _kind, _make = "light", _native.NativeLight

    def __init__(self, kind: str = "point", **properties: Any) -> None:
        super().__init__(kind=kind, **properties)


class Camera(Record):
    """A camera: position, target, up (three numbers each), vertical_fov (degrees), aperture_radius, focus_distance,
    projection ("perspective", "orthographic", "panorama"), orthographic_height (of the image; setting it makes
    rays parallel). Errors as of Material."""

    __slots__ = ()
    _kind, _make = "camera", _native.NativeCamera


class Records(MutableSequence[Any]):
    """The materials or the lights of a scene, as a list that changes the scene."""

    __slots__ = ("_scene", "_of")

    def __init__(self, scene: Scene, of: type[Record]) -> None:
        self._scene, self._of = scene, of

    def __len__(self) -> int:
        return self._scene._count(self._of._kind)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self._of._in(self._scene, i) for i in range(len(self))[index]]
        return self._of._in(self._scene, range(len(self))[operator.index(index)])

    def _natives(self) -> list[Any]:
        return [record._native() for record in self]

    def __setitem__(self, index: Any, value: Any) -> None:
        natives, name = self._natives(), self._of._kind
        natives[index] = ([native_of(name, one, self._of) for one in value] if isinstance(index, slice)
                          else native_of(name, value, self._of))
        self._scene._replace(name, natives)

    def __delitem__(self, index: Any) -> None:
        natives = self._natives()
        del natives[index]
        self._scene._replace(self._of._kind, natives)

    def insert(self, index: int, value: Any) -> None:
        natives = self._natives()
        natives.insert(index, native_of(self._of._kind, value, self._of))
        self._scene._replace(self._of._kind, natives)

    def pop(self, index: int = -1) -> Any:
        record = copy.copy(self[index])
        del self[index]
        return record

    def reverse(self) -> None:
        self[:] = self[::-1]

    def assign(self, values: Iterable[Any]) -> None:
        if isinstance(values, (str, Record)) or not isinstance(values, Iterable):
            raise UsageError(f"{self._of._kind}s: is a {type(values).__name__}; use a list of claray.{self._of.__name__}")
        self[:] = list(values)

    def __repr__(self) -> str:
        return repr(list(self))
