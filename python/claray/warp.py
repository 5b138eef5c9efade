"""Warp's queries of meshes for arrays of rays and points, with claray as the engine.

    mesh = claray.warp.Mesh(points, indices)
    hits = claray.warp.mesh_query_ray(mesh, start, dir, 1e6)
    hits.result, hits.t, hits.face, hits.u, hits.v, hits.sign, hits.normal

The functions have the names, arguments and conventions of Warp's functions of kernels, but take and return arrays. Warp need
not be installed. Where arguments are arrays of Warp, in host memory, so are the results. docs/drop_ins.md lists what differs.

As in Warp, u and v are the weights of a face's first and second vertex. Where nothing is found, result is False and all else
is 0. Numbers that are not finite find nothing. All functions raise UsageError, naming the argument, for wrong shapes, types
and values.
"""

from __future__ import annotations

import importlib
from functools import cached_property
from typing import Any, Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import MISS, Shape, as_array, distances, flag, indices, integer, number, places, vectors
from ._bvh import Bvh
from ._device import AnyDevice, Device, device_of
from ._lists import Lists, all_hits, box_overlaps, count_hits, sphere_overlaps
from ._points import nearest_point
from ._query import any_hit, closest_hit
from .errors import UsageError

_ALL = slice(None)
_ZERO = 2.0**-22
"""Weights up to this are 0: a few roundings of float32."""
_MOST_DIRECTIONS = 1 << 16
"""Each is a query of all points."""
_MOST_ANGLES = 1 << 14
"""Solid angles that are computed at once, so that caches hold what they need."""


class MeshQueryRay(NamedTuple):
    """The first hits of N rays: result (N,) bool; sign (N,), 1 in front of the face and -1 behind it; face (N,) int32; t (N,) in
    lengths of the direction; u, v (N,); normal (N, 3), the unit normal of the face's winding order. float32 otherwise."""

    result: Any
    sign: Any
    face: Any
    t: Any
    u: Any
    v: Any
    normal: Any


class MeshQueryPoint(NamedTuple):
    """The nearest points of N points: result (N,) bool; sign (N,), -1 inside and 1 outside; face (N,) int32; u, v (N,)."""

    result: Any
    sign: Any
    face: Any
    u: Any
    v: Any


class Mesh:
    """A mesh, with the interface of warp.Mesh.

    points: (V, 3). indices: (3 * T,), or (T, 3). support_winding_number: whether mesh_query_point_sign_winding_number uses
    winding numbers. bvh_constructor, bvh_leaf_size: accepted as by Warp; claray chooses its own. velocities, groups: refused.
    device: as of claray.Bvh.

    points is kept and not copied. After a change of its numbers, refit() moves the mesh.
    """

    def __init__(self, points: Any, indices: Any, velocities: None = None, support_winding_number: bool = False,
                 bvh_constructor: str | None = None, bvh_leaf_size: int | None = None, groups: None = None, *,
                 device: AnyDevice = None) -> None:
        for name, value in (("velocities", velocities), ("groups", groups)):
            if value is not None:
                raise UsageError(f"{name}: not supported; leave them out")
        self.support_winding_number = flag("support_winding_number", support_winding_number)
        self.indices, self._points, self._device = indices, points, device_of(device)
        corners = places("points", points, nan="omit")
        self._geometry = _Geometry(corners, _faces(indices, len(corners)))
        self._bvh = Bvh(corners, self._geometry.faces, device=self._device, nan="omit")

    @property
    def points(self) -> Any:
        """(V, 3), as given. As many others may be assigned, which moves the mesh."""
        return self._points

    @points.setter
    def points(self, points: Any) -> None:
        self._points = points
        self.refit()

    @property
    def device(self) -> Device:
        return self._device

    def refit(self) -> None:
        """Moves the mesh to the present numbers of points, and keeps the tree: fast, but queries get slower with more motion."""
        corners, faces = places("points", self._points), self._geometry.faces
        if len(corners) != len(self._geometry.corners):
            raise UsageError(f"points: has {len(corners)} rows, and the mesh has {len(self._geometry.corners)}")
        self._bvh.refit(corners)
        self._geometry = _Geometry(corners, faces)


class _Geometry:
    """Vertices (V, 3) and faces (T, 3), and what follows of them."""

    def __init__(self, corners: NDArray[np.float32], faces: NDArray[np.uint32]) -> None:
        self.corners, self.faces = corners.copy(), faces

    def triangles(self, faces: NDArray[Any] | slice) -> NDArray[np.float64]:
        """The corners of faces: (N, 3, 3)."""
        return self.corners[self.faces[faces]].astype(np.float64)

    @cached_property
    def normals(self) -> NDArray[np.float64]:
        """Unit normals of the faces; 0 for those of no area, and in a last row, which is that of MISS for take()."""
        return np.vstack([_unit(_areas(self.triangles(_ALL))), np.zeros(3)])

    def normals_of(self, faces: NDArray[Any]) -> NDArray[np.float64]:
        return self.normals.take(faces, axis=0, mode="clip")

    @cached_property
    def vertices(self) -> NDArray[np.int64]:
        """The numbers of the faces' vertices (T, 3), where vertices at one place are one."""
        number: NDArray[np.int64] = np.unique(self.corners + np.float32(0), axis=0, return_inverse=True)[1].reshape(-1)  # -0 is 0
        return number[self.faces]

    @cached_property
    def feature_normals(self) -> NDArray[np.float64]:
        """(T, 8, 3): pseudonormals of each face's features, by the set of corners, as bits, whose weight is 0 there. Those of an
        edge are the sum of its faces' normals, those of a vertex their sum weighted by angles (Baerentzen and Aanaes 2005, "Signed
        distance computation using the angle weighted pseudonormal")."""
        normals, corners = self.normals[:-1], self.triangles(_ALL)
        features = np.zeros((len(normals), 8, 3))
        features[:, 0] = normals
        edges = np.unique(self.edges_of(self.vertices[:, [1, 2, 0]], self.vertices[:, [2, 0, 1]]), return_inverse=True)[1]
        features[:, [1, 2, 4]] = _sums(edges.reshape(-1), normals.repeat(3, axis=0)).reshape(-1, 3, 3)
        along = _unit(np.roll(corners, -1, axis=1) - corners)
        angles = np.arccos(np.clip(-_dot(along, np.roll(along, 1, axis=1)), -1, 1))
        features[:, [6, 5, 3]] = _sums(self.vertices.reshape(-1), (angles[..., None] * normals[:, None]).reshape(-1, 3)).reshape(-1, 3, 3)
        return features

    def edges_of(self, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> NDArray[np.int64]:
        """A number for each edge between two vertices, in either direction."""
        return np.minimum(starts, ends) * len(self.corners) + np.maximum(starts, ends)

    @cached_property
    def cap(self) -> NDArray[np.float64]:
        """Triangles (B, 3, 3) from each border edge to one point, which close the mesh."""
        used = np.isfinite(self.triangles(_ALL)).all(axis=(1, 2))
        starts, ends = self.vertices[used].reshape(-1), np.roll(self.vertices[used], -1, axis=1).reshape(-1)
        place = np.zeros(self.corners.shape)
        place[self.vertices] = self.corners[self.faces]
        edges, edge = np.unique(self.edges_of(starts, ends), return_inverse=True)
        upwards = np.bincount(edge.reshape(-1), np.sign(ends - starts), len(edges)).astype(np.int64)  # more often than downwards
        low, high = place[edges // len(place)], place[edges % len(place)]
        rising = upwards[:, None] > 0
        apex = np.broadcast_to(place[starts].mean(axis=0).astype(np.float32).astype(np.float64), low.shape)
        return np.stack([np.where(rising, high, low), np.where(rising, low, high), apex], axis=1).repeat(np.abs(upwards), axis=0)


def mesh_query_ray(mesh: Mesh, start: Any, dir: Any, max_t: Any) -> MeshQueryRay:
    """The first hit of each ray that is nearer than max_t.

    start, dir: (N, 3), or another shape such as (H, W, 3). max_t: one number or (N,), in lengths of the direction.
    """
    starts, towards, shape = _rays(start, dir)
    hits = closest_hit(_bvh(mesh), starts, towards, tmax=_before("max_t", max_t, shape), closed=True, nan="miss")
    normals = mesh._geometry.normals_of(hits["primitive"])
    found = hits["primitive"] != MISS
    sign = np.where(_dot(normals, towards) < 0, 1, -1) * found
    numbers = {"result": found, "sign": sign, "face": hits["primitive"] * found, "t": np.where(found, hits["t"], 0),
               **_weights(hits, found), "normal": normals}
    return MeshQueryRay(**_in_kind(numbers, shape, start))


def mesh_query_ray_anyhit(mesh: Mesh, start: Any, dir: Any, max_t: Any) -> Any:
    """Whether each ray hits anything nearer than max_t, as bool. Arguments are those of mesh_query_ray."""
    starts, towards, shape = _rays(start, dir)
    hit = any_hit(_bvh(mesh), starts, towards, tmax=_before("max_t", max_t, shape), closed=True, nan="miss")
    return _in_kind({"hit": hit}, shape, start)["hit"]


def mesh_query_ray_count_intersections(mesh: Mesh, start: Any, dir: Any) -> Any:
    """How many times each ray crosses the mesh, as int32. A crossing at an edge or a vertex counts once."""
    starts, towards, shape = _rays(start, dir)
    return _in_kind({"count": count_hits(_bvh(mesh), starts, towards, nan="miss").astype(np.int32)}, shape, start)["count"]


def mesh_query_point(mesh: Mesh, point: Any, max_dist: Any) -> MeshQueryPoint:
    """The nearest point of the mesh for each point, if it is nearer than max_dist.

    point: (N, 3), or another shape such as (H, W, 3). max_dist: one number or (N,). The sign is that of Warp: of three rays
    along the axes, a point is inside if two or more first hit a face from behind.
    """
    return _query_point(mesh, point, max_dist, lambda points, near: _inside_by_axes(mesh, points))


def mesh_query_point_no_sign(mesh: Mesh, point: Any, max_dist: Any) -> MeshQueryPoint:
    """As mesh_query_point, with signs of 0."""
    return _query_point(mesh, point, max_dist, None)


def mesh_query_point_sign_normal(mesh: Mesh, point: Any, max_dist: Any, epsilon: float = 1e-3) -> MeshQueryPoint:
    """As mesh_query_point, with signs by the pseudonormal of the nearest face, edge or vertex.

    epsilon: accepted as by Warp, which calls nearly equal distances equal; claray knows the nearest feature without it.
    """
    return _query_point(mesh, point, max_dist, lambda points, near: _inside_by_normals(mesh._geometry, points, near))


def mesh_query_point_sign_parity(mesh: Mesh, point: Any, max_dist: Any, n_sample: int = 1,
                                 perturbation_scale: float = 0.1) -> MeshQueryPoint:
    """As mesh_query_point, with signs by the parity of crossings, which are counted exactly.

    n_sample: of so many rays (at most 65,536), at least half must cross the mesh an odd number of times for a point to be inside.
    perturbation_scale: how far the numbers of the rays' directions are from 1. The directions are those of Warp.
    """
    directions = _directions(integer("n_sample", n_sample, 1, _MOST_DIRECTIONS), number("perturbation_scale", perturbation_scale))

    def inside(points: NDArray[Any], near: NDArray[Any]) -> NDArray[np.bool_]:
        odd = np.zeros(len(points), np.int64)
        for towards in directions:
            odd += count_hits(_bvh(mesh), points, towards) & 1
        return 2 * odd >= n_sample

    return _query_point(mesh, point, max_dist, inside)


def mesh_query_point_sign_winding_number(mesh: Mesh, point: Any, max_dist: Any, accuracy: float = 2.0,
                                         threshold: float = 0.5) -> MeshQueryPoint:
    """As mesh_query_point, with a point inside if its winding number is above threshold.

    accuracy: accepted as by Warp, which approximates winding numbers; claray's are those of float64. Without
    support_winding_number the sign is that of mesh_query_point, as in Warp.
    """
    least = number("threshold", threshold)
    if not _checked(mesh).support_winding_number:
        return mesh_query_point(mesh, point, max_dist)
    return _query_point(mesh, point, max_dist, lambda points, near: _winding_numbers(mesh, points) > least)


def mesh_query_aabb(mesh: Mesh, low: Any, high: Any) -> Lists:
    """The faces that overlap each box of corners low and high, (N, 3), in ascending order: lists[i]."""
    return box_overlaps(_bvh(mesh), vectors("low", low)[0], vectors("high", high)[0])


def mesh_query_sphere(mesh: Mesh, center: Any, radius: Any) -> Lists:
    """The faces that overlap each sphere, in ascending order: lists[i]. center: (N, 3). radius: one number or (N,)."""
    centers, shape = vectors("center", center)
    return sphere_overlaps(_bvh(mesh), centers, np.maximum(distances("radius", radius, shape), 0))


def mesh_eval_position(mesh: Mesh, face: Any, bary_u: Any, bary_v: Any) -> Any:
    """The points (N, 3) of faces (N,) with weights bary_u and bary_v, (N,), of their first and second vertex."""
    geometry = _checked(mesh)._geometry
    corners = geometry.triangles(_numbers_of("face", face, len(geometry.faces)))
    weights = (("bary_u", bary_u), ("bary_v", bary_v))
    u, v = (distances(name, value, corners.shape[:-2]).reshape(*corners.shape[:-2], 1) for name, value in weights)
    place = u * corners[..., 0, :] + v * corners[..., 1, :] + (1 - u - v) * corners[..., 2, :]
    return _in_kind({"place": place.reshape(-1, 3)}, place.shape[:-1], face)["place"]


def mesh_eval_face_normal(mesh: Mesh, face: Any) -> Any:
    """The unit normals (N, 3) of faces (N,), of their winding order."""
    geometry = _checked(mesh)._geometry
    normals = geometry.normals_of(_numbers_of("face", face, len(geometry.faces)))
    return _in_kind({"normal": normals.reshape(-1, 3)}, normals.shape[:-1], face)["normal"]


def mesh_get_index(mesh: Mesh, face_vertex_index: Any) -> Any:
    """The vertices (N,) of the numbers (N,) in mesh.indices."""
    faces = _checked(mesh)._geometry.faces
    numbers = _numbers_of("face_vertex_index", face_vertex_index, faces.size)
    return _in_kind({"index": faces.reshape(-1)[numbers].astype(np.int32)}, numbers.shape, face_vertex_index)["index"]


def mesh_get_point(mesh: Mesh, index: Any) -> Any:
    """The places (N, 3) of the vertices of the numbers (N,) in mesh.indices."""
    geometry = _checked(mesh)._geometry
    numbers = _numbers_of("index", index, geometry.faces.size)
    corners = geometry.corners[geometry.faces.reshape(-1)[numbers.reshape(-1)]]
    return _in_kind({"point": corners}, numbers.shape, index)["point"]


def _query_point(mesh: Mesh, point: Any, max_dist: Any,
                 inside: Callable[[NDArray[Any], NDArray[Any]], NDArray[np.bool_]] | None) -> MeshQueryPoint:
    """inside: decides for points and their nearest places."""
    bvh = _bvh(mesh)
    points, shape = vectors("point", point)
    most = distances("max_dist", max_dist, shape)
    near = nearest_point(bvh, points, reach=max(0.0, float(most.max(initial=0))), nan="miss")
    found = (near["primitive"] != MISS) & (near["distance"] < most)
    sign = np.zeros(len(points))
    if inside is not None:
        sign[found] = np.where(inside(points[found], near[found]), -1, 1)
    numbers = {"result": found, "sign": sign, "face": near["primitive"] * found, **_weights(near, found)}
    return MeshQueryPoint(**_in_kind(numbers, shape, point))


def _inside_by_axes(mesh: Mesh, points: NDArray[Any]) -> NDArray[np.bool_]:
    votes = np.zeros(len(points), np.int64)
    for axis in range(3):
        hits = closest_hit(mesh._bvh, points, np.eye(3)[axis])
        votes += mesh._geometry.normals_of(hits["primitive"])[:, axis] > 0
    return votes >= 2


def _inside_by_normals(geometry: _Geometry, points: NDArray[Any], near: NDArray[Any]) -> NDArray[np.bool_]:
    u, v = near["u"].astype(np.float64), near["v"].astype(np.float64)
    feature = (1 - u - v <= _ZERO) * 1 + (u <= _ZERO) * 2 + (v <= _ZERO) * 4
    corner = np.array([0, 1, 0, 2, 0, 1, 0, 0])[feature]  # one of the feature, so that its place has no rounding
    faces = near["primitive"]
    towards = points - geometry.triangles(faces)[np.arange(len(points)), corner]
    return _dot(geometry.feature_normals[faces, feature], towards) <= 0


def _winding_numbers(mesh: Mesh, points: NDArray[Any]) -> NDArray[np.float64]:
    """The generalized winding number: that of the closed mesh, which is an integer that one ray counts, less that of the cap, which is
    its solid angle over 4 pi (Jacobson et al. 2013, "Robust inside-outside segmentation using generalized winding numbers")."""
    geometry = mesh._geometry
    cap, bvh, normals = geometry.cap, mesh._bvh, geometry.normals
    if len(cap):
        corners = np.concatenate([geometry.corners, cap.reshape(-1, 3).astype(np.float32)])
        faces = np.concatenate([geometry.faces, len(geometry.corners) + np.arange(3 * len(cap), dtype=np.uint32).reshape(-1, 3)])
        bvh, normals = Bvh(corners, faces, device=mesh.device, nan="omit"), np.vstack([normals[:-1], _unit(_areas(cap))])
    towards = _directions(1, 0.1)[0].astype(np.float64)
    lists = all_hits(bvh, points, towards)
    leaves = np.where(normals[lists.elements["primitive"]] @ towards > 0, 1, -1)
    turns = np.asarray(np.bincount(lists.queries, leaves, len(points)), np.float64)
    step = max(1, _MOST_ANGLES // max(1, len(cap)))
    for first in range(0, len(points) if len(cap) else 0, step):
        turns[first:first + step] -= _solid_angles(cap, points[first:first + step]).sum(axis=1) / (4 * np.pi)
    return turns


def _solid_angles(triangles: NDArray[np.float64], points: NDArray[Any]) -> NDArray[np.float64]:
    """Of triangles (T, 3, 3) as points (N, 3) see them, positive from behind: (N, T). Van Oosterom and Strackee 1983, "The solid angle
    of a plane triangle"."""
    corners, seen_from = triangles.transpose(1, 2, 0).copy(), points.T.astype(np.float64, order="C")  # rows for each coordinate
    a, b, c = (corner[:, None] - seen_from[:, :, None] for corner in corners)  # (3, N, T)
    la, lb, lc = (np.sqrt((to * to).sum(axis=0)) for to in (a, b, c))
    volume = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    rest = la * lb * lc + (a * b).sum(axis=0) * lc + (b * c).sum(axis=0) * la + (c * a).sum(axis=0) * lb
    angles: NDArray[np.float64] = 2 * np.arctan2(volume, rest)
    return angles


def _directions(count: int, scale: float) -> NDArray[np.float32]:
    """The directions along which Warp counts crossings (mesh_query_inside_parity in mesh.h): (1, 1, 1), each number off by up to scale,
    of the hash PCG with the seed 42 (Jarzynski and Olano 2020, "Hash functions for GPU rendering")."""
    state = _pcg(42)
    draws: list[float] = []
    for _ in range(3 * count):
        state = _pcg(state)
        draws.append((state >> 8) * 2.0**-24)
    return np.float32(1) + (2 * np.float32(scale) * np.array(draws, np.float32) - np.float32(scale)).reshape(-1, 3)


def _pcg(state: int) -> int:
    state = (state * 747796405 + 2891336453) & 0xFFFFFFFF
    word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) & 0xFFFFFFFF
    return (word >> 22) ^ word


def _checked(mesh: Any) -> Mesh:
    if not isinstance(mesh, Mesh):
        raise UsageError(f"mesh: is a {type(mesh).__name__}; use a claray.warp.Mesh")
    return mesh


def _bvh(mesh: Any) -> Bvh:
    return _checked(mesh)._bvh


def _faces(value: Any, end: int) -> NDArray[np.uint32]:
    array = as_array("indices", value)
    if array.ndim == 1 and array.size % 3 == 0:
        array = array.reshape(-1, 3)
    if array.size == 0:
        raise UsageError("indices: empty; a mesh needs at least one face")
    return indices("indices", array, 3, end, "points").copy()


def _numbers_of(name: str, value: Any, end: int) -> NDArray[Any]:
    array = as_array(name, value)
    if array.dtype.kind not in "iu" or (array.size and not (0 <= int(array.min()) and int(array.max()) < end)):
        raise UsageError(f"{name}: must hold integers from 0 to {end - 1}")
    return array


def _rays(start: Any, dir: Any) -> tuple[NDArray[Any], NDArray[Any], Shape]:
    starts, shape = vectors("start", start)
    towards, other = vectors("dir", dir)
    if shape != other:
        raise UsageError(f"dir: has shape {other} of vectors, but start has {shape}")
    return starts, towards, shape


def _before(name: str, value: Any, shape: Shape) -> NDArray[np.float32]:
    """The largest numbers below these: a hit must be nearer."""
    with np.errstate(over="ignore"):
        return np.nextafter(distances(name, value, shape).astype(np.float32), np.float32(-np.inf))


def _weights(found_at: NDArray[Any], found: NDArray[np.bool_]) -> dict[str, NDArray[Any]]:
    """Of the first and second vertex; claray has those of the second and third."""
    u, v = found_at["u"], found_at["v"]
    return {"u": np.where(found, 1 - u - v, 0), "v": np.where(found, u, 0)}


def _areas(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """The cross products of the edges of triangles (T, 3, 3)."""
    with np.errstate(invalid="ignore", over="ignore"):  # where triangles are not finite
        return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def _unit(values: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths: NDArray[np.float64] = np.linalg.norm(values, axis=-1, keepdims=True)
    return np.divide(values, lengths, out=np.zeros_like(values), where=lengths > 0)


def _dot(a: NDArray[Any], b: NDArray[Any]) -> NDArray[np.float64]:
    products: NDArray[np.float64] = np.einsum("...i,...i->...", a, b, dtype=np.float64)
    return products


def _sums(groups: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """For each row of values (N, 3) the sum of all rows of its group."""
    return np.stack([np.asarray(np.bincount(groups, values[:, k]), np.float64)[groups] for k in range(3)], axis=1)


def _in_kind(arrays: dict[str, NDArray[Any]], shape: Shape, argument: Any) -> dict[str, Any]:
    """Arrays of rows as results of the argument's kind and of this shape: bool, int32 or float32."""
    results: dict[str, NDArray[Any]] = {}
    for name, array in arrays.items():
        kind = np.bool_ if array.dtype == bool else np.int32 if array.dtype.kind in "iu" and name != "sign" else np.float32
        results[name] = np.ascontiguousarray(array, kind).reshape(*shape, *array.shape[1:])
    if type(argument).__module__.split(".")[0] != "warp":
        return results
    warp = importlib.import_module("warp")
    return {name: warp.array(array, dtype=warp.vec3 if array.ndim > len(shape) else getattr(warp, array.dtype.name))
            for name, array in results.items()}
