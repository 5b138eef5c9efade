"""Hits that queries leave out, by a text of the caller."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arrays import as_array
from ._handle import Handle
from .errors import UsageError

NO_FILTER = _native.NativeFilter()


class Filter(Handle):
    """Decides which hits count, by OpenCL C that defines

        static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit);

    hit has the members t, u, v, primitive and geometry. The function is called for hits in any order, some of them behind
    the closest one, and must return the same for the same hit.

    source: the text. data: (n,) numbers that are passed to the function as float32. name: for messages of the compiler.
    A text that does not compile raises DeviceError, with the compiler's log, at the first query.
    """

    __slots__ = ("_given", "_native")

    def __init__(self, source: str, data: ArrayLike = (), name: str = "filter") -> None:
        if not isinstance(source, str) or not source.strip():
            raise UsageError("source: must be a text that defines accept_hit")
        numbers = as_array("data", data)
        if numbers.dtype.kind not in "fiu" or numbers.ndim != 1:
            raise UsageError(f"data: has dtype {numbers.dtype} and shape {numbers.shape}; use numbers of shape (n,)")
        self._given = source, np.array(numbers, np.float32), str(name)
        self._native = _native.NativeFilter(self.name, *self._given[:2])

    @property
    def name(self) -> str:
        return self._given[2]

    def __reduce_ex__(self, protocol: Any) -> Any:
        return Filter, self._given

    def __repr__(self) -> str:
        return f"<claray.Filter {self.name!r}>"


def geometry_range(first: int, end: int) -> Filter:
    """Accepts hits of the geometries `first` to `end` - 1."""
    for name, value in (("first", first), ("end", end)):
        if not isinstance(value, (int, np.integer)) or not 0 <= value < 2**32:
            raise UsageError(f"{name}: is {value!r}; use a number of a geometry")
    source = (
        "static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit) {\n"
        f"    return hit->geometry >= {int(first)}u && hit->geometry < {int(end)}u;\n}}\n")
    return Filter(source, name="geometry_range")
