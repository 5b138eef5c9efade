"""Conversion and checks of array arguments. Errors begin with the argument's name."""

from __future__ import annotations

import math
import os
from contextlib import contextmanager
from typing import Any, Generator, Iterable, TypeGuard, Union, cast

import numpy as np
from numpy.typing import NDArray

from ._handle import warn
from .errors import UsageError

Shape = tuple[int, ...]

RAY = np.dtype({"names": ["origin", "tmin", "direction", "tmax"], "formats": ["3f4", "f4", "3f4", "f4"]})
"""A ray: 32 bytes."""
HIT = np.dtype([("t", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("geometry", "u4")])
"""A hit: 20 bytes. Columns are views: hits['t']."""
INSTANCE_HIT = np.dtype([*((name, HIT[name]) for name in HIT.names or ()), ("instance", "u4")])
"""A hit of an InstancedBvh: 24 bytes. Its triangle and weights are those of the instance's structure."""
NEAREST = np.dtype([("point", "3f4"), ("distance", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("geometry", "u4")])
"""The nearest point of a surface: 32 bytes."""
NEAREST64 = np.dtype([(name, "3f8" if name == "point" else NEAREST[name]) for name in NEAREST.names or ()])
"""The same of a structure with an origin: the point is float64."""
MISS = 0xFFFFFFFF
"""The primitive of a ray that hits nothing."""

_MOST_ROUNDING = 1e-5
"""Of coordinates, relative to their extent."""

# The types of arguments. Named as such, type checkers leave what passes isinstance() with them as it was: Any.
_WHOLE: tuple[type[Any], ...] = (int, np.integer)
_COLLECTION: tuple[type[Any], ...] = (list, tuple, set, frozenset, dict)

NO_WORDS = np.empty(0, np.uint32)
NO_FLOATS = np.empty(0, np.float32)


def _is_array(value: Any) -> TypeGuard[NDArray[Any]]:
    return isinstance(value, np.ndarray)


def as_array(name: str, value: Any) -> NDArray[Any]:
    """The array of `value`: NumPy's, any object with __dlpack__ or __array__ in host memory, or nested sequences."""
    if _is_array(value):
        return value
    if hasattr(value, "__dlpack__"):
        device = value.__dlpack_device__()[0]
        device = getattr(device, "value", device)  # of an enumeration, as Open3D gives it
        if device not in (1, 3, 13):  # kDLCPU, kDLCUDAHost, kDLCUDAManaged
            raise UsageError(f"{name}: the array is in device memory (DLPack device {device}); copy it to the host")
        if not getattr(value, "requires_grad", False):
            try:
                return np.from_dlpack(value)
            except (BufferError, RuntimeError, TypeError):
                pass  # such as a format that NumPy lacks: try __array__
            except ValueError as error:
                raise UsageError(f"{name}: its __dlpack__ does not work ({error})") from None
    try:
        return np.asarray(value)
    except (ValueError, TypeError, RuntimeError) as error:
        raise UsageError(f"{name}: not an array of numbers ({error})") from None


def floats(name: str, value: Any, columns: int) -> NDArray[Any]:
    """float32 or float64 of shape (N, columns), of any strides. Integers and float16 are converted."""
    array = as_array(name, value)
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise UsageError(f"{name}: has dtype {array.dtype}; use float32, float64 or integers")
    if array.ndim != 2 or array.shape[1] != columns:
        raise UsageError(f"{name}: has shape {array.shape}; it must be (N, {columns})")
    if array.dtype not in (np.dtype(np.float32), np.dtype(np.float64)) or not array.dtype.isnative or not array.flags.aligned:
        array = array.astype(np.float32 if array.dtype.itemsize < 4 else array.dtype.newbyteorder("=")
                             if array.dtype.kind == "f" else np.float64)
    return array


def vectors(name: str, value: Any, columns: int = 3) -> tuple[NDArray[Any], Shape]:
    """As floats, of shape (N, columns), from any shape (..., columns); and the shape without its last number."""
    array = as_array(name, value)
    if array.ndim > 2 and array.shape[-1] == columns:
        return floats(name, array.reshape(-1, columns), columns), array.shape[:-1]
    array = floats(name, array, columns)
    return array, array.shape[:1]


def places(name: str, value: Any, nan: str = "raise", origin: Origin = None) -> NDArray[np.float32]:
    """Contiguous float32 of shape (N, 3), relative to an origin. Warns where float32 rounds much of what the places are apart. With
    another `nan` than "raise", numbers that are not finite stay."""
    given = local(floats(name, value, 3), origin)
    if nan == "raise":
        result = finite(name, given)
        _warn_of_rounding(name, given, result)
    else:
        result = _as_float32(given)
        usable = np.isfinite(result).all(axis=1)
        _warn_of_rounding(name, given[usable], result[usable])
    return result


def _warn_of_rounding(name: str, given: NDArray[Any], result: NDArray[np.float32]) -> None:
    if given.dtype == np.float64 and len(given):
        extent = float(np.ptp(given, axis=0).max())
        if float(np.abs(result).max()) * 2.0**-24 > _MOST_ROUNDING * extent > 0:  # else no need to look at each
            rounding = float(np.abs(given - result).max())
            if rounding > _MOST_ROUNDING * extent:
                warn(f"{name}: float32 rounds them by up to {rounding:.2g}, and their extent is {extent:.3g}; "
                     "pass origin='auto' to a claray.Bvh, or subtract an origin near them, from rays and points, too")


Origin = Union[NDArray[np.float64], None]
"""(3,) of a structure's local coordinates; None: they are those of the world."""


def origin_of(value: Any, vertices: NDArray[Any]) -> Origin:
    """The origin that a structure is asked for: (3,) numbers, or "auto" for the middle of its vertices."""
    if value is None:
        return None
    if isinstance(value, str):
        check_choice("origin", value, ("auto",))
        usable = vertices[np.isfinite(vertices).all(axis=1)].astype(np.float64, copy=False)
        return 0.5 * usable.min(axis=0) + 0.5 * usable.max(axis=0) if len(usable) else np.zeros(3)
    place: NDArray[np.float64] = distances("origin", value, 3).copy()
    if not np.isfinite(place).all():
        raise UsageError(f"origin: is {value!r}; use finite numbers")
    return place


def local(points: NDArray[Any], origin: Origin) -> NDArray[Any]:
    """Points (..., 3) relative to a structure's origin, by float64."""
    return points if origin is None else np.subtract(points, origin, dtype=np.float64)


def _as_float32(array: NDArray[Any]) -> NDArray[np.float32]:
    """Contiguous. Too large numbers become infinite."""
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array, dtype=np.float32)


def finite(name: str, array: NDArray[Any]) -> NDArray[np.float32]:
    """Contiguous float32. NaN, infinite and too large numbers are errors that name the row."""
    result = _as_float32(array)
    if not np.isfinite(result).all():
        row = int(np.argwhere(~np.isfinite(result).all(axis=1))[0, 0])
        raise UsageError(f"{name}: row {row} is {array[row]}, which is not finite in float32; remove such rows")
    return result


def finite_vector(name: str, value: Any, shape: int | Shape) -> NDArray[np.float32]:
    """Contiguous float32 in a row, from an array of this shape or one number. Numbers that are not finite are errors."""
    array = distances(name, value, shape)
    return finite(name, array[:, None])[:, 0]


def flag(name: str, value: Any) -> bool:
    if not isinstance(value, (*_WHOLE, np.bool_)) or value not in (0, 1):
        raise UsageError(f"{name}: is {value!r}; use True or False")  # bool("no") is True
    return bool(value)


def number(name: str, value: Any) -> float:
    if isinstance(value, str) or not np.isscalar(value):
        raise UsageError(f"{name}: is {value!r}; use a number")
    try:
        return float(value)  # type: ignore[arg-type]  # complex: TypeError
    except (TypeError, ValueError):
        raise UsageError(f"{name}: is {value!r}; use a number") from None


def integer(name: str, value: Any, low: int, high: int) -> int:
    if not isinstance(value, _WHOLE) or isinstance(value, bool) or not low <= value <= high:
        raise UsageError(f"{name}: is {value!r}; use an integer from {low} to {high}")
    return int(value)


def path_of(name: str, value: Any) -> str:
    """The name of a file or folder."""
    text = cast("object", os.fspath(value)) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(text, str) or "\0" in text:
        raise UsageError(f"{name}: is {value!r}; use the path of a file")
    return text


@contextmanager
def naming(name: str) -> Generator[None, None, None]:
    """Lets the library's errors about an argument begin with its name."""
    try:
        yield
    except UsageError as error:
        raise UsageError(f"{name}: {error}") from None


def text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise UsageError(f"{name}: is {value!r}; use a text")
    return value


def members(name: str, values: Any, of_what: str) -> list[Any]:
    """The members of a list or another iterable, except text and arrays of numbers."""
    kind: str = type(values).__name__
    if isinstance(values, (str, bytes, bytearray, memoryview, np.ndarray)) or not isinstance(values, Iterable):
        raise UsageError(f"{name}: is a {kind}; use a list of {of_what}")
    several: list[Any] = list(values)  # pyright: ignore[reportUnknownArgumentType]  # checked by the callers
    return several


def names_of(name: str, value: Any) -> str:
    """One name or several, with commas between them."""
    several: Any = [value] if isinstance(value, str) else value
    if not isinstance(several, _COLLECTION) or not all(isinstance(one, str) for one in several):
        raise UsageError(f"{name}: is {value!r}; use a name or a list of names")
    return ",".join(several)


def check_choice(name: str, value: Any, choices: tuple[str, ...]) -> None:
    if not isinstance(value, str) or value not in choices:
        raise UsageError(f"{name}: unknown name {value!r}; use one of {', '.join(choices)}")


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """The nearest of the public names, as the end of a message; empty if none is near."""
    import difflib  # for those who need it: it costs a hundredth of a second

    near = difflib.get_close_matches(name, [one for one in names if not one.startswith("_")], 1)
    return f"; did you mean '{near[0]}'?" if near else ""


def builder_called(name: Any) -> str:
    """The library checks the name itself, if it is one."""
    if not isinstance(name, str):
        raise UsageError(f"builder: is {name!r}; use 'automatic' or another name")
    return name


def indices(name: str, value: Any, columns: int, end: int, of: str) -> NDArray[np.uint32]:
    """Contiguous uint32 of shape (N, columns), of indices below `end`."""
    array = as_array(name, value)
    if array.dtype.kind not in "iu":
        raise UsageError(f"{name}: has dtype {array.dtype}; use an integer type")
    if array.ndim != 2 or array.shape[1] != columns:
        raise UsageError(f"{name}: has shape {array.shape}; it must be (N, {columns})")
    if array.size:
        low, high = int(array.min()), int(array.max())
        if low < 0 or high >= end:
            raise UsageError(f"{name}: holds the index {low if low < 0 else high}, but {of} has {end} rows")
    return np.ascontiguousarray(array, dtype=np.uint32)


def _size(shape: int | Shape) -> Shape:
    return shape if isinstance(shape, tuple) else (shape,)


def words(name: str, value: Any, shape: int | Shape) -> NDArray[np.uint32]:
    """Contiguous uint32 in a row, of an array of this shape; or an empty array for None."""
    if value is None:
        return NO_WORDS
    array = as_array(name, value)
    if array.dtype.kind not in "iu":
        raise UsageError(f"{name}: has dtype {array.dtype}; use an integer type")
    if array.shape != _size(shape):
        raise UsageError(f"{name}: has shape {array.shape}; it must be {_size(shape)}")
    if array.size and (int(array.min()) < 0 or int(array.max()) > MISS):
        raise UsageError(f"{name}: holds numbers outside 0 to 2**32 - 1")
    return np.ascontiguousarray(array.ravel(), dtype=np.uint32)


def distances(name: str, value: Any, shape: int | Shape) -> NDArray[Any]:
    """One number, or one for each ray, as float64 in a row. NaN is an error."""
    array = as_array(name, value)
    if array.dtype.kind not in "fiu":
        raise UsageError(f"{name}: has dtype {array.dtype}; use a number or an array of numbers")
    if array.ndim != 0 and array.shape != _size(shape):
        raise UsageError(f"{name}: has shape {array.shape}; use one number, or {_size(shape)}")
    array = np.asarray(array, dtype=np.float64)
    if np.isnan(array).any():
        raise UsageError(f"{name}: holds NaN")
    return array.ravel() if array.ndim else np.broadcast_to(array, math.prod(_size(shape)))


def output(name: str, out: Any, shape: Shape, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The caller's array for results, or a new one."""
    if out is None:
        return np.empty(shape, dtype)
    if not _is_array(out) or out.dtype != dtype or out.shape != shape:
        given = f"{out.dtype} of shape {out.shape}" if _is_array(out) else type(out).__name__
        raise UsageError(f"{name}: is {given}; use an array of shape {shape} with dtype {dtype}")
    if not out.flags.c_contiguous or not out.flags.writeable:
        raise UsageError(f"{name}: must be contiguous and writeable")
    return out


def pointer(name: str, value: Any) -> int:
    """The OpenCL handle of an integer or of an object with int_ptr, such as pyopencl's."""
    handle = getattr(value, "int_ptr", value)
    if not isinstance(handle, int) or isinstance(handle, bool):
        raise UsageError(f"{name}: is a {type(value).__name__}; use an object of pyopencl, or its int_ptr")
    return handle
