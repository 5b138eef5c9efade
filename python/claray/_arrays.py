"""Conversion and checks of array arguments. Errors begin with the argument's name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import UsageError

RAY = np.dtype({"names": ["origin", "tmin", "direction", "tmax"], "formats": ["3f4", "f4", "3f4", "f4"]})
"""A ray: 32 bytes."""
HIT = np.dtype([("t", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("geometry", "u4")])
"""A hit: 20 bytes. Columns are views: hits['t']."""
INSTANCE_HIT = np.dtype([*((name, HIT.fields[name][0]) for name in HIT.names), ("instance", "u4")])
"""A hit of an InstancedBvh: 24 bytes. Its triangle and weights are those of the instance's structure."""
NEAREST = np.dtype([("point", "3f4"), ("distance", "f4"), ("u", "f4"), ("v", "f4"), ("primitive", "u4"), ("geometry", "u4")])
"""The nearest point of a surface: 32 bytes."""
MISS = 0xFFFFFFFF
"""The primitive of a ray that hits nothing."""

NO_WORDS = np.empty(0, np.uint32)
NO_FLOATS = np.empty(0, np.float32)


def as_array(name: str, value: Any) -> NDArray[Any]:
    """The array of `value`: NumPy's, any object with __dlpack__ or __array__ in host memory, or nested sequences."""
    if isinstance(value, np.ndarray):
        return value
    if hasattr(value, "__dlpack__"):
        device = value.__dlpack_device__()[0]
        if device not in (1, 3, 13):  # kDLCPU, kDLCUDAHost, kDLCUDAManaged
            raise UsageError(f"{name}: the array is in device memory (DLPack device {device}); copy it to the host")
        if not getattr(value, "requires_grad", False):
            try:
                return np.from_dlpack(value)
            except (BufferError, RuntimeError, TypeError):
                pass  # such as a format that NumPy lacks: try __array__
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
    if array.dtype not in (np.float32, np.float64) or not array.dtype.isnative or not array.flags.aligned:
        array = array.astype(np.float32 if array.dtype.itemsize < 4 else array.dtype.newbyteorder("=")
                             if array.dtype.kind == "f" else np.float64)
    return array


def finite(name: str, array: NDArray[Any]) -> NDArray[np.float32]:
    """Contiguous float32. NaN, infinite and too large numbers are errors that name the row."""
    with np.errstate(over="ignore"):
        result = np.ascontiguousarray(array, dtype=np.float32)
    if not np.isfinite(result).all():
        row = int(np.argwhere(~np.isfinite(result).all(axis=1))[0, 0])
        raise UsageError(f"{name}: row {row} is {array[row]}, which is not finite in float32; remove such rows")
    return result


def finite_vector(name: str, value: Any, count: int) -> NDArray[np.float32]:
    """Contiguous float32 of shape (count,), from as many numbers or one. Numbers that are not finite are errors."""
    array = distances(name, value, count)
    return finite(name, array[:, None])[:, 0]


def check_choice(name: str, value: Any, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise UsageError(f"{name}: unknown name {value!r}; use one of {', '.join(choices)}")


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


def words(name: str, value: Any, count: int) -> NDArray[np.uint32]:
    """Contiguous uint32 of shape (count,), or an empty array for None."""
    if value is None:
        return NO_WORDS
    array = as_array(name, value)
    if array.dtype.kind not in "iu":
        raise UsageError(f"{name}: has dtype {array.dtype}; use an integer type")
    if array.shape != (count,):
        raise UsageError(f"{name}: has shape {array.shape}; it must be ({count},)")
    if array.size and (int(array.min()) < 0 or int(array.max()) > MISS):
        raise UsageError(f"{name}: holds numbers outside 0 to 2**32 - 1")
    return np.ascontiguousarray(array, dtype=np.uint32)


def distances(name: str, value: Any, count: int) -> NDArray[Any]:
    """One number, or one for each ray, as float64 of shape (count,). NaN is an error."""
    array = as_array(name, value)
    if array.dtype.kind not in "fiu":
        raise UsageError(f"{name}: has dtype {array.dtype}; use a number or an array of numbers")
    if array.ndim != 0 and array.shape != (count,):
        raise UsageError(f"{name}: has shape {array.shape}; use one number, or ({count},)")
    array = np.asarray(array, dtype=np.float64)
    if np.isnan(array).any():
        raise UsageError(f"{name}: holds NaN")
    return np.broadcast_to(array, (count,))


def output(name: str, out: Any, count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The caller's array for results, or a new one."""
    if out is None:
        return np.empty(count, dtype)
    if not isinstance(out, np.ndarray) or out.dtype != dtype or out.shape != (count,):
        given = f"{out.dtype} of shape {out.shape}" if isinstance(out, np.ndarray) else type(out).__name__
        raise UsageError(f"{name}: is {given}; use an array of {count} elements with dtype {dtype}")
    if not out.flags.c_contiguous or not out.flags.writeable:
        raise UsageError(f"{name}: must be contiguous and writeable")
    return out


def pointer(name: str, value: Any) -> int:
    """The OpenCL handle of an integer or of an object with int_ptr, such as pyopencl's."""
    handle = getattr(value, "int_ptr", value)
    if not isinstance(handle, int) or isinstance(handle, bool):
        raise UsageError(f"{name}: is a {type(value).__name__}; use an object of pyopencl, or its int_ptr")
    return handle
