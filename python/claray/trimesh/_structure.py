"""Structures over the parts of a mesh, and queries of them in float64."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any, Iterator, cast

import numpy as np
import trimesh
from numpy.typing import NDArray

from .. import _native
from .._arrays import MISS, finite
from .._bvh import Bvh
from .._device import AnyDevice
from .._lists import all_hits, sphere_overlaps
from .._points import inside, nearest_point
from .._query import any_hit, closest_hit

library: Any = trimesh
"""trimesh, most of whose functions have no types."""
TOLERANCE: float = library.tol.merge
"""Up to where trimesh takes places as one."""
_BACK = 8
"""By how many roundings of vertices and origins rays begin before their origins."""
_NEAR = 2.0**-20
"""Weights of hits on borders, and differences of distances, relative to them, of one place: some roundings of float32."""
_FAR, _MOST_PARTS = 64.0, 8
"""Parts of a mesh have frames of their own if the gap between them is so many times as wide as the smaller one."""
_ROUNDING = 2.0**-24
"""Of a number to float32, relative to it."""
_EQUAL = 2.0**-49
"""Squared distances that differ by so much are equal: some roundings of float64."""
_MOST_CANDIDATES = 1 << 22
"""Pairs of points and triangles that are held in memory at once."""


class Structure:
    """The parts of a mesh."""

    def __init__(self, mesh: Any, device: AnyDevice) -> None:
        corners, faces = np.asarray(mesh.triangles, np.float64), np.asarray(mesh.faces)
        parts = _parts_of(corners.min(axis=1), corners.max(axis=1))
        self.parts = [_Part(mesh.vertices, faces, corners, part, device) for part in parts]

    def first(self, origins: NDArray[Any], directions: NDArray[Any]) -> NDArray[np.int64]:
        found = [part.first(origins, directions) for part in self.parts]
        triangles, distances = np.stack([t for t, _ in found]), np.stack([d for _, d in found])
        best: NDArray[np.int64] = triangles[distances.argmin(axis=0), np.arange(len(origins))]
        return best

    def any(self, origins: NDArray[Any], directions: NDArray[Any]) -> NDArray[np.bool_]:
        found: NDArray[np.bool_] = np.logical_or.reduce([part.any(origins, directions) for part in self.parts])
        return found

    def inside(self, points: NDArray[Any]) -> NDArray[np.bool_]:
        crossed: NDArray[np.bool_] = np.stack([inside(part.bvh, part.in_frame(points)) for part in self.parts])
        return cast("NDArray[np.bool_]", crossed.sum(axis=0) % 2 == 1)

    def nearest(self, points: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
        """The nearest points of the surface, their distances, and triangles."""
        found = [part.nearest(points) for part in self.parts]
        places, distances, triangles = (np.stack(arrays) for arrays in zip(*found))
        best = distances.argmin(axis=0), np.arange(len(points))
        return places[best], distances[best], triangles[best]

    def hits(self, origins: NDArray[Any], directions: NDArray[Any], most: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Triangles and rays of all hits: the first hits of all rays, then the second, and so on."""
        if most == 1:
            first = self.first(origins, directions)
            rays = np.flatnonzero(first >= 0)
            return first[rays], rays
        found = [part.hits(origins, directions) for part in self.parts]
        rays, distances, triangles = (np.concatenate(arrays) for arrays in zip(*found))
        order = np.lexsort((triangles, distances, rays))
        rays, triangles = rays[order], triangles[order]
        ranks = np.arange(len(rays)) - np.searchsorted(rays, rays)
        order = np.argsort(ranks, kind="stable")
        order = order[: np.searchsorted(ranks[order], most)]
        return triangles[order], rays[order]


class _Part:
    """A Bvh of some triangles in a frame where they are centred and about 1 in size: scaled by a power of two, which is
    exact."""

    def __init__(self, vertices: NDArray[Any], faces: NDArray[Any], corners: NDArray[np.float64], part: NDArray[np.int64],
                 device: AnyDevice) -> None:
        self.triangles, self._corners_of_mesh = part, corners
        used, indices = np.unique(faces[part], return_inverse=True)
        places = np.asarray(vertices, np.float64)[used]
        low, high = places.min(axis=0), places.max(axis=0)
        self.centre = 0.5 * low + 0.5 * high
        extent = float((high - low).max())
        self.scale = 2.0 ** -math.frexp(extent)[1] if 0 < extent < math.inf else 1.0
        places = self.in_frame(places)
        self.rounding = float(np.abs(places - places.astype(np.float32)).max())
        self.bvh = Bvh(places, indices.reshape(-1, 3), device=device)

    @cached_property
    def _corners(self) -> NDArray[np.float64]:
        """The triangles in the frame: (T, 3, 3)."""
        return self.in_frame(self._corners_of_mesh[self.triangles])

    @cached_property
    def _normals(self) -> NDArray[np.float64]:
        """Of unit length, or 0 for triangles of no area: (T, 3)."""
        directions, usable = library.triangles.normals(self._corners)
        result = np.zeros((len(usable), 3))
        result[usable] = directions
        return result

    def in_frame(self, points: NDArray[Any]) -> NDArray[np.float64]:
        moved: NDArray[np.float64] = np.subtract(points, self.centre, dtype=np.float64)
        moved *= self.scale
        return moved

    def start(self, origins: NDArray[Any], directions: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins in the frame, a little back along their rays: a surface on which a ray begins is hit. And how far."""
        lengths = np.sqrt(np.einsum("ij,ij->i", directions, directions, dtype=np.float64))
        starts = self.in_frame(origins)
        back = _BACK * (self.rounding + _ROUNDING * np.clip(np.abs(starts).max(axis=1), _ROUNDING, 1))
        back = np.divide(back, lengths, out=np.zeros_like(lengths), where=lengths > 0)
        starts -= back[:, None] * directions
        return starts, back

    def first(self, origins: NDArray[Any], directions: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Triangles, or -1, and distances in the mesh's unit."""
        starts, back = self.start(origins, directions)
        hits = closest_hit(self.bvh, starts, directions, closed=True)
        found = hits["primitive"] != MISS
        triangles = np.full(len(hits), -1, np.int64)
        triangles[found] = self.triangles[hits["primitive"][found]]
        return triangles, (hits["t"] - back) / self.scale

    def any(self, origins: NDArray[Any], directions: NDArray[Any]) -> NDArray[np.bool_]:
        return any_hit(self.bvh, self.start(origins, directions)[0], directions, closed=True)

    def hits(self, origins: NDArray[Any], directions: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Rays, distances in the mesh's unit, triangles."""
        starts, back = self.start(origins, directions)
        lists = all_hits(self.bvh, starts, directions, closed=True)
        rays, hits = lists.queries, lists.elements
        on_border = np.minimum(np.minimum(hits["u"], hits["v"]), 1 - hits["u"] - hits["v"]) <= _NEAR
        touching = np.unique(rays[on_border])
        if len(touching):
            crossings = all_hits(self.bvh, starts[touching], directions[touching])
            count = len(self.triangles)
            crosses = np.isin(rays * count + hits["primitive"],
                              touching[crossings.queries] * count + crossings.elements["primitive"])
            crosses |= ~np.isin(rays, touching)
            kept = _one_for_each_place(rays, hits["t"].astype(np.float64), crosses)
            rays, hits = rays[kept], hits[kept]
        return rays, (hits["t"] - back[rays]) / self.scale, self.triangles[hits["primitive"]]


    def nearest(self, points: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
        """The nearest points of the surface, their distances, and triangles, all decided in float64.

        Rounding moves a point p by at most 2^-24 |p|, and the vertices of the frame by less than 2^-24. The nearest triangle
        therefore touches a sphere around the rounded p that is so much larger than the distance to any triangle.
        """
        places = self.in_frame(points)
        rounded = finite("points", places)
        guess = nearest_point(self.bvh, rounded)["primitive"]
        bounds = np.linalg.norm(places - closest_point(self._corners[guess], places), axis=1)
        bounds += 2 * _ROUNDING * (np.linalg.norm(places, axis=1) + 1)
        spheres = np.column_stack([rounded, np.nextafter(bounds.astype(np.float32), np.float32(np.inf))])
        best = np.concatenate([self._nearest_in(places[part], spheres[part]) for part in self._portions(spheres)])
        nearest = closest_point(self._corners[best], places)
        distances = np.linalg.norm(places - nearest, axis=1)
        return self.centre + nearest / self.scale, distances / self.scale, self.triangles[best]

    def _portions(self, spheres: NDArray[np.float32]) -> Iterator[slice]:
        """Spheres in portions that have few triangles, or one sphere each."""
        counts = np.zeros(len(spheres), np.uint32)
        _native.count_sphere_overlaps(self.bvh._native, spheres, counts)
        ends = np.cumsum(counts, dtype=np.int64)
        first = 0
        while first < len(spheres):
            before = int(ends[first - 1]) if first else 0
            last = max(first + 1, int(np.searchsorted(ends, before + _MOST_CANDIDATES, side="right")))
            yield slice(first, last)
            first = last

    def _nearest_in(self, places: NDArray[np.float64], spheres: NDArray[np.float32]) -> NDArray[np.int64]:
        """The nearest of the triangles that each sphere touches. As in trimesh, the one that faces the point most is taken
        where squared distances agree to tol.merge; here also relative to them."""
        lists = sphere_overlaps(self.bvh, spheres[:, :3], spheres[:, 3])
        points, triangles, first = lists.queries, lists.elements, lists.offsets[:-1].astype(np.int64)
        away: NDArray[np.float64] = places[points] - closest_point(self._corners[triangles], places[points])
        squares: NDArray[np.float64] = np.einsum("ij,ij->i", away, away)
        least = np.minimum.reduceat(squares, first)
        near = np.maximum(TOLERANCE * np.minimum(least, self.scale**2), _EQUAL * (least + np.sqrt(least)))
        cosines: NDArray[np.float64] = np.einsum("ij,ij->i", away, self._normals[triangles]) / np.sqrt(np.where(squares > 0, squares, 1))
        facing = np.where(squares <= (least + near)[points], np.round(cosines / TOLERANCE), -np.inf)
        return triangles[np.lexsort((squares, -facing, points))[first]].astype(np.int64)


def closest_point(corners: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The nearest point of each triangle (N, 3, 3) to the point (N, 3) of its row."""
    nearest: NDArray[np.float64] = library.triangles.closest_point(corners, points)
    return nearest


def _one_for_each_place(rays: NDArray[Any], distances: NDArray[Any], crosses: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which hits count: those that cross the surface, and one of those that only touch it where none crosses. Hits are in
    the order of rays and distances."""
    if len(rays) == 0:
        return crosses
    begins = np.ones(len(rays), bool)
    begins[1:] = (rays[1:] != rays[:-1]) | (distances[1:] - distances[:-1] > _NEAR * distances[1:])
    places = np.cumsum(begins) - 1
    crossed = np.logical_or.reduceat(crosses, np.flatnonzero(begins))
    counted: NDArray[np.bool_] = crosses | (begins & ~crossed[places])
    return counted


def _parts_of(low: NDArray[np.float64], high: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """Triangles, by the corners of their boxes (T, 3), in parts that gaps separate which are wide beside the smaller part.
    In one frame for all, float32 could not resolve it."""
    whole: list[NDArray[np.int64]] = [np.arange(len(low))]
    parts: list[NDArray[np.int64]] = []
    while whole:
        part = whole.pop()
        first = _before_widest_gap(low[part], high[part]) if len(whole) + len(parts) + 2 <= _MOST_PARTS else None
        if first is None:
            parts.append(part)
        else:
            whole += [part[first], part[~first]]
    return parts


def _before_widest_gap(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_] | None:
    """Which boxes lie before the widest gap along an axis; None if it is not wide."""
    best, first = 0.0, None
    for axis in range(3):
        order = np.argsort(low[:, axis], kind="stable")
        gaps = low[order[1:], axis] - np.maximum.accumulate(high[order[:-1], axis])
        if len(gaps) and gaps.max() > best:
            best, first = float(gaps.max()), np.zeros(len(low), bool)
            first[order[: gaps.argmax() + 1]] = True
    if first is None:
        return None
    smaller = min(float((high[side].max(axis=0) - low[side].min(axis=0)).max()) for side in (first, ~first))
    return first if best > _FAR * smaller else None
