"""Queries that find any number of things: all hits of rays, and triangles that overlap boxes and spheres."""

from __future__ import annotations

from typing import Any, Iterator, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import HIT, MISS, finite, finite_vector, flag, integer, local, vectors, words
from ._bvh import Bvh, check_bvh
from ._filter import Filter
from ._query import native_filter, packed_rays
from .errors import UsageError


class Lists:
    """A list of results for each query: lists[i], in a row in `elements`, from offsets[i] to offsets[i + 1]."""

    __slots__ = ("offsets", "elements")

    def __init__(self, offsets: NDArray[np.uint32], elements: NDArray[Any]) -> None:
        if not isinstance(offsets, np.ndarray) or offsets.ndim != 1 or len(offsets) == 0 or offsets.dtype.kind not in "iu":
            raise UsageError("offsets: must be an array of integers, one more than there are queries")
        if not isinstance(elements, np.ndarray) or elements.ndim != 1 or len(elements) != offsets[-1]:
            raise UsageError("elements: must be an array of as many elements as the last of offsets")
        self.offsets, self.elements = offsets, elements

    @property
    def counts(self) -> NDArray[np.int64]:
        """The number of results of each query: (N,)."""
        offsets = self.offsets.astype(np.int64)
        return offsets[1:] - offsets[:-1]

    @property
    def queries(self) -> NDArray[np.int64]:
        """The query that each element belongs to: as many as there are elements."""
        return np.repeat(np.arange(len(self)), self.counts)

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> NDArray[Any]:
        i = range(len(self))[index]
        return self.elements[self.offsets[i]:self.offsets[i + 1]]

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<claray.Lists of {len(self)} queries and {len(self.elements)} results>"


def count_hits(bvh: Bvh, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
               tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, cull_back_faces: bool = False, closed: bool = False,
               filter: Filter | None = None, nan: Literal["raise", "miss"] = "raise") -> NDArray[np.uint32]:
    """Counts the triangles that each ray hits, as N uint32. A ray through an edge counts once.

    closed: all triangles count that the ray touches, so that one through an edge counts twice, and one through a vertex
    as often as there are triangles. Other arguments and errors are those of closest_hit.
    """
    check_bvh(bvh)
    rays, shape = packed_rays(bvh, origins, directions, tmin, tmax, nan)
    results = np.zeros(len(rays), np.uint32)
    visible, accepted = words("masks", masks, shape), native_filter(filter)
    if len(rays):
        _native.count_hits(bvh._native, rays, flag("cull_back_faces", cull_back_faces), flag("closed", closed), visible, accepted, results)
    return results.reshape(shape)


def nearest_hits(bvh: Bvh, origins: ArrayLike, directions: ArrayLike | None = None, *, most: int, tmin: ArrayLike = 0.0,
                 tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, cull_back_faces: bool = False, closed: bool = False,
                 filter: Filter | None = None, nan: Literal["raise", "miss"] = "raise") -> NDArray[Any]:
    """Finds the `most` nearest hits of each ray, in order of distance, at equal distances of triangles.

    Returns hits of dtype HIT and shape (N, most). Behind the last hit of a ray, 'primitive' is MISS and 't' is tmax. Takes
    20 bytes for each of N * most hits; all_hits takes only as much as there are hits. closed: as of count_hits. Other
    arguments and errors are those of closest_hit.
    """
    check_bvh(bvh)
    most = integer("most", most, 1, 2**32 - 1)
    rays, shape = packed_rays(bvh, origins, directions, tmin, tmax, nan)
    hits, counts = np.empty((len(rays), most), HIT), np.zeros(len(rays), np.uint32)
    visible, accepted = words("masks", masks, shape), native_filter(filter)
    if len(rays):
        as_bytes = hits.view(np.uint8).reshape(len(rays), most, HIT.itemsize)
        _native.nearest_hits(bvh._native, rays, most, flag("cull_back_faces", cull_back_faces), flag("closed", closed), visible, accepted, as_bytes, counts)
    none = np.arange(most) >= counts[:, None]
    hits[none] = np.array((0, 0, 0, MISS, MISS), HIT)
    hits["t"][none] = np.broadcast_to(rays[:, 7:8], none.shape)[none]
    return hits.reshape(*shape, most)


def all_hits(bvh: Bvh, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
             tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, cull_back_faces: bool = False, closed: bool = False,
             filter: Filter | None = None, nan: Literal["raise", "miss"] = "raise") -> Lists:
    """Finds all hits of each ray, in order of distance, at equal distances of triangles.

    Returns Lists of hits of dtype HIT: hits[i] are those of ray i, in the order of rows if rays have a shape such as
    (H, W, 3). closed: as of count_hits. Other arguments and errors are those of closest_hit, and UsageError for more than
    4e9 hits.
    """
    check_bvh(bvh)
    rays, shape = packed_rays(bvh, origins, directions, tmin, tmax, nan)
    visible, accepted = words("masks", masks, shape), native_filter(filter)
    if len(rays) == 0:
        return Lists(np.zeros(1, np.uint32), np.empty(0, HIT))
    offsets, elements = _native.all_hits(bvh._native, rays, flag("cull_back_faces", cull_back_faces), flag("closed", closed), visible, accepted)
    return Lists(offsets, elements.view(HIT).reshape(-1))


def box_overlaps(bvh: Bvh, lows: ArrayLike, highs: ArrayLike) -> Lists:
    """Finds the triangles that overlap each solid box, in ascending order.

    lows, highs: (N, 3) corners. Boxes and triangles that touch overlap; a box with a low above its high overlaps nothing.
    Decided in float64. Returns Lists of uint32. Raises UsageError, naming the argument, for wrong shapes, types and
    numbers that are not finite.
    """
    check_bvh(bvh)
    low, high = (finite(name, local(vectors(name, corners)[0], bvh._origin)) for name, corners in (("lows", lows), ("highs", highs)))
    if len(low) != len(high):
        raise UsageError(f"highs: has {len(high)} rows, but lows has {len(low)}")
    return _overlaps(_native.box_overlaps, bvh, np.hstack([low, high]))


def sphere_overlaps(bvh: Bvh, centers: ArrayLike, radii: ArrayLike) -> Lists:
    """Finds the triangles that overlap each solid sphere, in ascending order.

    centers: (N, 3). radii: (N,), or one number; spheres of negative radius overlap nothing. As box_overlaps otherwise.
    """
    check_bvh(bvh)
    given, shape = vectors("centers", centers)
    places = finite("centers", local(given, bvh._origin))
    return _overlaps(_native.sphere_overlaps, bvh, np.column_stack([places, finite_vector("radii", radii, shape)]))


def _overlaps(query: Any, bvh: Bvh, shapes: NDArray[np.float32]) -> Lists:
    if len(shapes) == 0:
        return Lists(np.zeros(1, np.uint32), np.empty(0, np.uint32))
    return Lists(*query(bvh._native, np.ascontiguousarray(shapes)))
