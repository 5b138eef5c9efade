"""Queries by points: the nearest point of a surface, whether a point is inside, and its signed distance."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import NEAREST, NEAREST64, Shape, check_choice, finite, local, number, output, vectors, words
from ._bvh import Bvh, check_bvh
from ._handle import warn
from .errors import UsageError


def _checked(bvh: Bvh, points: ArrayLike, nan: str) -> tuple[NDArray[np.float32], Shape]:
    """The points as contiguous float32 in a row, and the shape of the results."""
    check_bvh(bvh)
    check_choice("nan", nan, ("raise", "miss"))
    given, shape = vectors("points", points)
    given = local(given, bvh._origin)
    if nan == "raise":
        return finite("points", given), shape
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(given, np.float32), shape


def _votes(bvh: Bvh, open: str) -> bool:
    """Whether several rays decide for each point, because the mesh is open."""
    check_choice("open", open, ("warn", "raise", "vote"))
    if bvh.is_closed or open == "vote":
        return not bvh.is_closed
    line = "the mesh is not closed, so that inside and outside are not defined everywhere"
    if open == "raise":
        raise UsageError(f"bvh: {line}; close it, or pass open='vote'")
    warn(f"bvh: {line}; pass open='vote' for the majority of 16 rays, or open='raise'")
    return False


def _reach(reach: Any) -> float:
    distance = number("reach", reach)
    if not distance >= 0:
        raise UsageError(f"reach: is {distance}; use a distance of 0 or more")
    return distance


def nearest_point(bvh: Bvh, points: ArrayLike, *, reach: float = np.inf, masks: ArrayLike | None = None,
                  nan: Literal["raise", "miss"] = "raise", out: NDArray[Any] | None = None) -> NDArray[Any]:
    """Finds the point of the surface that is nearest to each point.

    points: (N, 3) or another shape, such as (H, W, 3), in the unit of the vertices; float64 is rounded to float32. reach: the largest distance at which a
    point is found. masks: (N,) a point sees geometries whose mask shares a bit with its own. nan: "raise": a point that
    is not finite is an error; "miss": it finds nothing. out: an array of N elements of dtype NEAREST to be filled.

    Returns N elements of dtype NEAREST: 'point' (3 numbers), 'distance', 'primitive' (index of the triangle), 'u', 'v'
    (weights of its second and third vertex) and 'geometry'. If nothing is in reach: the point itself, `reach` and MISS.
    Of a structure with an origin the dtype is NEAREST64, whose points are float64. Distances are computed in float64; among equal float32 distances the lowest triangle is returned.

    Releases the GIL. Raises UsageError, naming the argument, for wrong shapes, types and values.
    """
    given, shape = _checked(bvh, points, nan)
    visible = words("masks", masks, shape)
    results = output("out", out, shape, NEAREST if bvh._origin is None else NEAREST64)
    found = results if bvh._origin is None else np.empty(shape, NEAREST)
    limit = _reach(reach)
    if len(given):
        _native.nearest_point(bvh._native, given, limit, visible, found.reshape(-1).view(np.uint8).reshape(len(given), -1))
    if bvh._origin is not None:
        results[...] = found
        results["point"] += bvh._origin
    return results


def inside(bvh: Bvh, points: ArrayLike, *, open: Literal["warn", "raise", "vote"] = "warn",
           nan: Literal["raise", "miss"] = "raise") -> NDArray[np.bool_]:
    """Returns for each point whether it is inside of the closed mesh, as N bool.

    points: as for nearest_point. nan: "miss": points that are not finite are outside.
    open: what is done if the mesh is not closed (see Bvh.is_closed). "warn": a warning, and one ray decides; "raise":
    UsageError; "vote": the majority of 16 rays decides. That helps if some triangles are missing. Of a terrain only
    the tops of hills then have an inside.

    A point is inside if a ray from it crosses the surface an odd number of times. Each crossing counts once, also at
    edges and vertices; with float64 on the device the count is exact. A point on the surface may be either. If meshes
    overlap each other, the answer is still that parity. Errors are those of nearest_point.
    """
    given, shape = _checked(bvh, points, nan)
    vote = _votes(bvh, open)
    results = np.zeros(len(given), np.uint8)
    if len(given):
        _native.inside(bvh._native, given, vote, results)
    return results.view(bool).reshape(shape)


def signed_distance(bvh: Bvh, points: ArrayLike, *, reach: float = np.inf, masks: ArrayLike | None = None,
                    open: Literal["warn", "raise", "vote"] = "warn", nan: Literal["raise", "miss"] = "raise") -> NDArray[np.float32]:
    """Returns the distance of each point to the surface, negative inside of the closed mesh, as N float32.

    points, reach, masks, nan: as for nearest_point. open: as for inside. Farther than reach, it is reach, or -reach inside. (trimesh's and
    libigl's functions of this name differ in the sign: trimesh is positive inside.)
    """
    given, shape = _checked(bvh, points, nan)
    visible = words("masks", masks, shape)
    limit, vote = _reach(reach), _votes(bvh, open)
    results = np.empty(len(given), np.float32)
    if len(given):
        _native.signed_distance(bvh._native, given, limit, visible, vote, results)
    return results.reshape(shape)
