"""Affine matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array, finite
from .errors import UsageError


def rows_of(name: str, value: Any) -> NDArray[np.float32]:
    """Affine matrices as (N, 3, 4) float32."""
    array = as_array(name, value)
    if array.dtype.kind not in "fiu" or array.ndim != 3 or array.shape[1:] not in ((4, 4), (3, 4)):
        raise UsageError(f"{name}: has dtype {array.dtype} and shape {array.shape}; use numbers of shape (N, 4, 4) or (N, 3, 4)")
    if array.shape[1] == 4:
        wrong = np.flatnonzero((array[:, 3] != (0, 0, 0, 1)).any(axis=1))
        if len(wrong):
            raise UsageError(f"{name}: the last row of matrix {wrong[0]} is {array[wrong[0], 3]}; it must be 0, 0, 0, 1")
    rows = np.ascontiguousarray(array[:, :3]).reshape(len(array), 12)
    return finite(name, rows).reshape(-1, 3, 4)
