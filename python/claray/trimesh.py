"""The interface of trimesh.ray with claray as the engine.

    mesh.ray = claray.trimesh.RayMeshIntersector(mesh)

or install() for all meshes. As trimesh's engines do, a first hit may be one where the ray only touches the surface, and
rays that begin on a surface hit it. All hits of a ray are counted exactly: one that passes through an edge or a vertex
counts once, also at a border or where the ray only touches, and surfaces at the same distance count each. Whether a point is inside of a watertight mesh is decided by
claray.inside.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import caching
from trimesh.ray.ray_util import contains_points

from ._arrays import MISS, floats
from ._bvh import Bvh
from ._device import AnyDevice
from ._lists import all_hits
from ._points import inside
from ._query import any_hit, closest_hit
from .errors import UsageError


_BACK = 2.0**-22
"""By how much rays begin before their origins, relative to the size of the frame: 4 to 8 roundings of float32."""
_NEAR = 2.0**-20
"""Weights of hits on borders, and differences of distances, relative to them, of one place: some roundings of float32."""
_FAR, _MOST_PARTS = 64.0, 8
"""Parts of a mesh have frames of their own if the gap between them is so many times as wide as the smaller one."""


class RayMeshIntersector:
    """Ray queries of a trimesh.Trimesh, on a device of OpenCL.

    mesh: a trimesh.Trimesh; the structure is built at the first query, and again after the mesh has changed.
    scale_to_box: accepted as trimesh's Embree engine has it; positions are always taken relative to the centre of the
    mesh; parts that are far from each other have centres of their own. device: as of claray.Bvh.
    """

    def __init__(self, mesh: Any = None, scale_to_box: bool = True, *, device: AnyDevice = None, geometry: Any = None) -> None:
        self.mesh = mesh if geometry is None else geometry
        if self.mesh is None:
            raise UsageError("mesh: missing; give a trimesh.Trimesh")
        self._scale_to_box, self._device = scale_to_box, device
        self._cache = caching.Cache(id_function=self.mesh.__hash__)

    @caching.cache_decorator
    def _structure(self) -> _Structure | None:
        return None if len(self.mesh.faces) == 0 else _Structure(self.mesh, self._device)

    def intersects_id(self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True,
                      max_hits: int = 100, return_locations: bool = False, **_: Any) -> tuple[NDArray[Any], ...]:
        """The triangles that rays hit.

        ray_origins, ray_directions: (n, 3). multiple_hits: all hits along a ray, or the first only. max_hits: per ray.
        Returns index_tri (m,), index_ray (m,) and, if return_locations, locations (m, 3).
        """
        origins, directions = _unit_rays(ray_origins, ray_directions)
        structure = self._structure
        if structure is None or len(origins) == 0:
            triangles, rays = np.zeros(0, np.int64), np.zeros(0, np.int64)
        else:
            triangles, rays = structure.hits(origins, directions, max_hits if multiple_hits else 1)
        if not return_locations:
            return triangles, rays
        return triangles, rays, self._locations(origins[rays], directions[rays], triangles)

    def intersects_location(self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True,
                            **options: Any) -> tuple[NDArray[Any], ...]:
        """The places where rays hit: locations (m, 3), index_ray (m,), index_tri (m,)."""
        triangles, rays, locations = self.intersects_id(ray_origins, ray_directions, multiple_hits=multiple_hits,
                                                        return_locations=True, **options)
        return locations, rays, triangles

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike, **_: Any) -> NDArray[np.int64]:
        """The index of the first triangle that each ray hits, or -1: (n,)."""
        origins, directions = _rays(ray_origins, ray_directions)
        if self._structure is None:
            return np.full(len(origins), -1, np.int64)
        return self._structure.first(origins, directions)

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike, **_: Any) -> NDArray[np.bool_]:
        """Whether each ray hits the mesh: (n,)."""
        origins, directions = _rays(ray_origins, ray_directions)
        if self._structure is None:
            return np.zeros(len(origins), bool)
        return self._structure.any(origins, directions)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point of (n, 3) is inside the mesh, by the parity of hits. Of a mesh that is not watertight, rays of
        several directions vote, as in trimesh."""
        structure = self._structure
        if structure is None or not self.mesh.is_watertight:
            return contains_points(self, points)
        return structure.inside(floats("points", points, 3))

    def _locations(self, origins: NDArray[Any], directions: NDArray[Any], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
        """The points of rays in the planes of triangles, in float64."""
        corners = self.mesh.triangles[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = np.einsum("ij,ij->i", normals, directions)
        to_plane = np.einsum("ij,ij->i", normals, corners[:, 0] - origins)
        distances = np.divide(to_plane, along, out=np.zeros_like(along), where=along != 0)
        return origins + distances[:, None] * directions

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key not in ("_cache", "_device")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._device = None
        self._cache = caching.Cache(id_function=self.mesh.__hash__)

    def __copy__(self, *_: Any) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box, device=self._device)

    def __deepcopy__(self, *_: Any) -> RayMeshIntersector:
        return self.__copy__()


class _Structure:
    """The parts of a mesh."""

    def __init__(self, mesh: Any, device: AnyDevice) -> None:
        corners, faces = np.asarray(mesh.triangles, np.float64), np.asarray(mesh.faces)
        parts = _parts_of(corners.min(axis=1), corners.max(axis=1))
        self.parts = [_Part(mesh.vertices, faces, part, device) for part in parts]

    def first(self, origins: NDArray[Any], directions: NDArray[Any]) -> NDArray[np.int64]:
        found = [part.first(origins, directions) for part in self.parts]
        triangles, distances = (np.stack(arrays) for arrays in zip(*found))
        return triangles[distances.argmin(axis=0), np.arange(len(origins))]

    def any(self, origins: NDArray[Any], directions: NDArray[Any]) -> NDArray[np.bool_]:
        return np.logical_or.reduce([part.any(origins, directions) for part in self.parts])

    def inside(self, points: NDArray[Any]) -> NDArray[np.bool_]:
        return np.logical_xor.reduce([inside(part.bvh, part.in_frame(points)) for part in self.parts])

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

    def __init__(self, vertices: NDArray[Any], faces: NDArray[Any], part: NDArray[np.int64], device: AnyDevice) -> None:
        self.triangles = part
        used, corners = np.unique(faces[part], return_inverse=True)
        places = np.asarray(vertices, np.float64)[used]
        low, high = places.min(axis=0), places.max(axis=0)
        self.centre = 0.5 * low + 0.5 * high
        extent = float((high - low).max())
        self.scale = 2.0 ** -math.frexp(extent)[1] if 0 < extent < math.inf else 1.0
        self.bvh = Bvh(self.in_frame(places), corners.reshape(-1, 3), device=device)

    def in_frame(self, points: NDArray[Any]) -> NDArray[np.float64]:
        moved = np.subtract(points, self.centre, dtype=np.float64)
        return np.multiply(moved, self.scale, out=moved)

    def start(self, origins: NDArray[Any], directions: NDArray[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origins in the frame, a little back along their rays: a surface on which a ray begins is hit. And how far."""
        lengths = np.sqrt(np.einsum("ij,ij->i", directions, directions, dtype=np.float64))
        back = np.divide(_BACK, lengths, out=np.zeros_like(lengths), where=lengths > 0)
        starts = self.in_frame(origins)
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


def _one_for_each_place(rays: NDArray[Any], distances: NDArray[Any], crosses: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which hits count: those that cross the surface, and one of those that only touch it where none crosses. Hits are in
    the order of rays and distances."""
    if len(rays) == 0:
        return crosses
    begins = np.ones(len(rays), bool)
    begins[1:] = (rays[1:] != rays[:-1]) | (distances[1:] - distances[:-1] > _NEAR * distances[1:])
    places = np.cumsum(begins) - 1
    crossed = np.logical_or.reduceat(crosses, np.flatnonzero(begins))
    return crosses | (begins & ~crossed[places])


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


def _rays(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    """Origins and directions, (n, 3)."""
    origins, directions = floats("ray_origins", ray_origins, 3), floats("ray_directions", ray_directions, 3)
    if origins.shape != directions.shape:
        raise UsageError(f"ray_directions: has {len(directions)} rows, but ray_origins has {len(origins)}")
    return origins, directions


def _unit_rays(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    """Origins and directions of unit length, (n, 3) float64, so that distances of all rays have the mesh's unit."""
    origins, directions = (array.astype(np.float64) for array in _rays(ray_origins, ray_directions))
    lengths = np.linalg.norm(directions, axis=1, keepdims=True)
    return origins, np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 0)


def install() -> None:
    """Makes claray the engine of all meshes of trimesh that are created from now on."""
    import trimesh.base
    import trimesh.ray

    for engine in ("ray_triangle", "ray_pyembree"):
        module = getattr(trimesh.ray, engine, None)
        if module is not None:
            module.RayMeshIntersector = RayMeshIntersector
