"""Queries by points: the nearest point of a surface, whether a point is inside, and its signed distance."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import NEAREST, check_choice, finite, floats, output, words
from ._bvh import Bvh, check_bvh
from .errors import UsageError


def _checked(bvh: Bvh, points: ArrayLike, nan: str) -> NDArray[np.float32]:
    """The points as contiguous float32."""
    check_bvh(bvh)
    check_choice("nan", nan, ("raise", "miss"))
    given = floats("points", points, 3)
    if nan == "raise":
        return finite("points", given)
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(given, np.float32)


def _reach(reach: Any) -> float:
    try:
        number = float(reach)
    except (TypeError, ValueError):
        raise UsageError(f"reach: is {reach!r}; use a number") from None
    if not number >= 0:
        raise UsageError(f"reach: is {number}; use a distance of 0 or more")
    return number


def nearest_point(bvh: Bvh, points: ArrayLike, *, reach: float = np.inf, masks: ArrayLike | None = None,
                  nan: Literal["raise", "miss"] = "raise", out: NDArray[Any] | None = None) -> NDArray[Any]:
    """Finds the point of the surface that is nearest to each point.

    points: (N, 3), in the unit of the vertices; float64 is rounded to float32. reach: the largest distance at which a
    point is found. masks: (N,) a point sees geometries whose mask shares a bit with its own. nan: "raise": a point that
    is not finite is an error; "miss": it finds nothing. out: an array of N elements of dtype NEAREST to be filled.

    Returns N elements of dtype NEAREST: 'point' (3 numbers), 'distance', 'primitive' (index of the triangle), 'u', 'v'
    (weights of its second and third vertex) and 'geometry'. If nothing is in reach: the point itself, `reach` and MISS.
    Distances are computed in float64; among equal float32 distances the lowest triangle is returned.

    Releases the GIL. Raises UsageError, naming the argument, for wrong shapes, types and values.
    """
    given = _checked(bvh, points, nan)
    visible = words("masks", masks, len(given))
    results = output("out", out, len(given), NEAREST)
    limit = _reach(reach)
    if len(given):
        _native.nearest_point(bvh._native, given, limit, visible, results.view(np.uint8).reshape(len(given), -1))
    return results


def inside(bvh: Bvh, points: ArrayLike, *, nan: Literal["raise", "miss"] = "raise") -> NDArray[np.bool_]:
    """Returns for each point whether it is inside of the closed mesh, as N bool.

    points: (N, 3). nan: "miss": points that are not finite are outside.

    A point is inside if a ray from it crosses the surface an odd number of times. Each crossing counts once, also at
    edges and vertices; with float64 on the device the count is exact. A point on the surface may be either. If meshes are
    open or overlap each other, the answer is still that parity. Errors are those of nearest_point.
    """
    given = _checked(bvh, points, nan)
    results = np.zeros(len(given), np.uint8)
    if len(given):
        _native.inside(bvh._native, given, results)
    return results.view(bool)


def signed_distance(bvh: Bvh, points: ArrayLike, *, reach: float = np.inf, masks: ArrayLike | None = None,
                    nan: Literal["raise", "miss"] = "raise") -> NDArray[np.float32]:
    """Returns the distance of each point to the surface, negative inside of the closed mesh, as N float32.

    points, reach, masks, nan: as for nearest_point. Farther than reach, it is reach, or -reach inside. (trimesh's and
    libigl's functions of this name differ in the sign: trimesh is positive inside.)
    """
    given = _checked(bvh, points, nan)
    visible = words("masks", masks, len(given))
    limit = _reach(reach)
    results = np.empty(len(given), np.float32)
    if len(given):
        _native.signed_distance(bvh._native, given, limit, visible, results)
    return results
