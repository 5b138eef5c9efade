"""The interface of Open3D's RaycastingScene with claray as the engine.

    scene = claray.open3d.RaycastingScene()
    scene.add_triangles(vertex_positions, triangle_indices)
    answers = scene.cast_rays(rays)

Open3D need not be installed. Where arguments are tensors of Open3D, so are the results. docs/drop_ins.md lists what differs.
"""

from __future__ import annotations

import importlib
from typing import Any, Callable, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import MISS, Shape, as_array, indices, number, places, vectors
from ._bvh import Bvh
from ._device import device_of
from ._lists import all_hits, count_hits
from ._points import inside, nearest_point
from ._query import any_hit, closest_hit
from .errors import UsageError


class Array(np.ndarray[Any, Any]):
    """A NumPy array with the methods of tensors that programs for Open3D call on results."""

    def numpy(self) -> NDArray[Any]:
        return self.view(np.ndarray)

    def cpu(self) -> Array:
        return self


class RaycastingScene:
    """Triangle meshes that rays and points query, with the methods, arguments and results of open3d.t.geometry.RaycastingScene.

    nthreads: accepted as by Open3D, here and in all methods; the device uses all its threads.
    device: None or Open3D's CPU:0 for claray.default_device(), or a device as of claray.Bvh. Arrays are in host memory.

    Arrays are those of claray.Bvh: NumPy's, or others in host memory, or tensors. Results are tensors if an argument is one,
    else NumPy arrays. Rays and points that are not finite hit and find nothing. All methods raise UsageError, naming the
    argument, for wrong shapes, types and values.
    """

    INVALID_ID: int = MISS
    """The geometry and primitive of a ray that hits nothing."""

    def __init__(self, nthreads: int = 0, device: Any = None) -> None:
        self._device = device_of(_name_of(device))
        self._meshes: list[tuple[NDArray[np.float32], NDArray[np.uint32]]] = []
        self._built: _Structure | None = None

    @overload
    def add_triangles(self, vertex_positions: Any, triangle_indices: Any) -> int: ...

    @overload
    def add_triangles(self, mesh: Any, /) -> int: ...

    @overload
    def add_triangles(self, *, mesh: Any) -> int: ...

    def add_triangles(self, vertex_positions: Any = None, triangle_indices: Any = None, *, mesh: Any = None) -> int:
        """Adds a mesh, which is copied, and returns its geometry ID. The structure is built at the next query.

        vertex_positions: (V, 3). triangle_indices: (T, 3). mesh: instead of both, an open3d.t.geometry.TriangleMesh.
        """
        if triangle_indices is None:
            vertex_positions, triangle_indices = _arrays_of(vertex_positions if mesh is None else mesh)
        corners = places("vertex_positions", _host("vertex_positions", vertex_positions), nan="omit").copy()
        faces = indices("triangle_indices", _host("triangle_indices", triangle_indices), 3, len(corners), "vertex_positions").copy()
        self._meshes.append((corners, faces))
        self._built = None
        return len(self._meshes) - 1

    def cast_rays(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:
        """The first hit of each ray.

        rays: (..., 6), origins and directions. Distances have the length of the direction as their unit.
        Returns t_hit (...), inf on a miss; geometry_ids and primitive_ids (...), INVALID_ID on a miss; primitive_uvs
        (..., 2), the weights of the second and third vertex; primitive_normals (..., 3), of unit length, or 0 on a miss.
        """
        given, shape = vectors("rays", _host("rays", rays), 6)
        structure = self._structure
        hits = closest_hit(structure.bvh, given[:, :3], given[:, 3:], closed=True, nan="miss")
        return _in_kind({"t_hit": hits["t"], **structure.places_of(hits), "primitive_normals": structure.normals_of(hits)},
                        shape, rays)

    def test_occlusions(self, rays: Any, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0) -> Any:
        """Whether each ray of (..., 6) hits anything between tnear and tfar, as bool (...)."""
        given, shape = vectors("rays", _host("rays", rays), 6)
        near, far = number("tnear", tnear), number("tfar", tfar)
        if not near >= 0:
            raise UsageError(f"tnear: is {near}; use 0 or more")
        hit = any_hit(self._structure.bvh, given[:, :3], given[:, 3:], tmin=near, tmax=far, closed=True, nan="miss")
        return _maker(rays)(hit.reshape(shape))

    def count_intersections(self, rays: Any, nthreads: int = 0) -> Any:
        """How many times each ray of (..., 6) crosses a surface, as int32 (...). A crossing at an edge or a vertex counts once."""
        given, shape = vectors("rays", _host("rays", rays), 6)
        counts = count_hits(self._structure.bvh, given[:, :3], given[:, 3:], nan="miss")
        return _maker(rays)(counts.astype(np.int32).reshape(shape))

    def list_intersections(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:
        """All crossings of each ray of (..., 6), ordered by distance: as many as count_intersections counts.

        Returns ray_splits (R + 1,): the crossings of ray i are ray_splits[i] to ray_splits[i + 1] - 1 of the others:
        ray_ids, t_hit, geometry_ids, primitive_ids (C,), and primitive_uvs (C, 2), as of cast_rays.
        """
        given, _ = vectors("rays", _host("rays", rays), 6)
        structure = self._structure
        lists = all_hits(structure.bvh, given[:, :3], given[:, 3:], nan="miss")
        found = {"ray_ids": lists.queries.astype(np.uint32), "t_hit": lists.elements["t"], **structure.places_of(lists.elements)}
        return {"ray_splits": _maker(rays)(lists.offsets), **_in_kind(found, lists.elements.shape, rays)}

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> dict[str, Any]:
        """The nearest point of the surfaces for each point of (..., 3).

        Returns points (..., 3), and geometry_ids, primitive_ids, primitive_uvs and primitive_normals as of cast_rays.
        """
        given, shape = vectors("query_points", _host("query_points", query_points))
        structure = self._structure
        near = nearest_point(structure.bvh, given, nan="miss")
        return _in_kind({"points": near["point"], **structure.places_of(near), "primitive_normals": structure.normals_of(near)},
                        shape, query_points)

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> Any:
        """The distance of each point of (..., 3) to the surfaces, as float32 (...); inf if there are none."""
        given, shape = vectors("query_points", _host("query_points", query_points))
        return _maker(query_points)(self._distance(given).reshape(shape))

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:
        """As compute_distance, but negative where compute_occupancy is 1."""
        given, shape = vectors("query_points", _host("query_points", query_points))
        sign = np.where(self._inside(given, nsamples), np.float32(-1), np.float32(1))
        return _maker(query_points)((sign * self._distance(given)).reshape(shape))

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:
        """Whether each point of (..., 3) is inside of the closed surfaces, as float32 (...), 0 or 1.

        A point is inside if a ray from it crosses the surfaces an odd number of times, which is counted exactly.
        nsamples: of so many rays, an odd number, the majority decides. One is enough unless surfaces have holes.
        """
        given, shape = vectors("query_points", _host("query_points", query_points))
        return _maker(query_points)(self._inside(given, nsamples).astype(np.float32).reshape(shape))

    @overload
    @staticmethod
    def create_rays_pinhole(intrinsic_matrix: Any, extrinsic_matrix: Any, width_px: int, height_px: int) -> Any: ...

    @overload
    @staticmethod
    def create_rays_pinhole(fov_deg: float, center: Any, eye: Any, up: Any, width_px: int, height_px: int) -> Any: ...

    @staticmethod
    def create_rays_pinhole(*arguments: Any, **named: Any) -> Any:
        """The rays through the centres of a camera's pixels: (height_px, width_px, 6).

        intrinsic_matrix: (3, 3), of pixels. extrinsic_matrix: (4, 4), from world to camera. Or: fov_deg: the horizontal
        field of view in degrees; center: (3,), what the camera looks at; eye: (3,), where it is; up: (3,).
        """
        rays_of = _rays_of_matrices if len(arguments) + len(named) <= 4 else _rays_of_view
        return _maker(*arguments, *named.values())(rays_of(*arguments, **named))

    @property
    def _structure(self) -> _Structure:
        if self._built is None:
            self._built = _Structure(self._meshes, self._device)
        return self._built

    def _distance(self, points: NDArray[Any]) -> NDArray[np.float32]:
        return np.ascontiguousarray(nearest_point(self._structure.bvh, points, nan="miss")["distance"])

    def _inside(self, points: NDArray[Any], nsamples: int) -> NDArray[np.bool_]:
        if not isinstance(nsamples, (int, np.integer)) or nsamples < 1 or nsamples % 2 == 0:
            raise UsageError(f"nsamples: is {nsamples!r}; use a positive odd number")
        bvh = self._structure.bvh
        if bvh.is_closed:  # all rays agree
            return inside(bvh, points, nan="miss")
        odd = np.zeros(len(points), np.int64)
        for towards in _directions(int(nsamples)):
            odd += count_hits(bvh, points, towards, nan="miss") & 1
        return odd > nsamples // 2


class _Structure:
    """The meshes in one Bvh, whose geometries they are. Without triangles it has one of no area, which nothing hits."""

    def __init__(self, meshes: list[tuple[NDArray[np.float32], NDArray[np.uint32]]], device: Any) -> None:
        meshes = meshes if any(len(faces) for _, faces in meshes) else [(np.zeros((1, 3), np.float32), np.zeros((1, 3), np.uint32))]
        counts = [len(faces) for _, faces in meshes]
        ends = np.cumsum([len(corners) for corners, _ in meshes])
        self._vertices = np.concatenate([corners for corners, _ in meshes])
        self._triangles = np.concatenate([faces + np.uint32(end - len(corners)) for end, (corners, faces) in zip(ends, meshes)])
        self._first = np.array([0, *np.cumsum(counts)], np.uint32)
        self._first[-1] = 0  # of MISS, which is the last one for take()
        self._normals: NDArray[np.float32] | None = None
        geometries = np.repeat(np.arange(len(meshes), dtype=np.uint32), counts)
        self.bvh = Bvh(self._vertices, self._triangles, geometries=geometries, device=device, nan="omit")

    def places_of(self, hits: NDArray[Any]) -> dict[str, NDArray[Any]]:
        """Where hits of dtype HIT or NEAREST are."""
        triangles = hits["primitive"]
        if len(self._first) > 2:
            triangles = triangles - self._first.take(hits["geometry"], mode="clip")
        weights = np.empty((len(hits), 2), np.float32)
        weights[:, 0], weights[:, 1] = hits["u"], hits["v"]
        return {"geometry_ids": hits["geometry"], "primitive_ids": triangles, "primitive_uvs": weights}

    def normals_of(self, hits: NDArray[Any]) -> NDArray[np.float32]:
        """Unit normals of triangles; 0 for MISS, which is the last row for take()."""
        normals = self._normals
        if normals is None:
            corners = self._vertices.astype(np.float64)[self._triangles]
            with np.errstate(invalid="ignore", over="ignore"):  # of triangles that are not finite
                areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                lengths = np.linalg.norm(areas, axis=1, keepdims=True)
                unit = np.divide(areas, lengths, out=np.zeros_like(areas), where=lengths > 0)
            self._normals = normals = np.vstack([unit, np.zeros(3)]).astype(np.float32)
        return normals.take(hits["primitive"], axis=0, mode="clip")


def install() -> None:
    """Makes open3d.t.geometry.RaycastingScene this module's class, for scenes that are created from now on."""
    importlib.import_module("open3d").t.geometry.RaycastingScene = RaycastingScene


def _name_of(device: Any) -> Any:
    """claray's name of a device, which Open3D may have named."""
    if not hasattr(device, "get_type"):
        return None if isinstance(device, str) and device == "CPU:0" else device
    if str(device).upper() != "CPU:0":
        raise UsageError(f"device: is {device}, but arrays must be in host memory; use CPU:0, or a device of claray")
    return None


def _arrays_of(mesh: Any) -> tuple[Any, Any]:
    try:
        return mesh.vertex["positions"], mesh.triangle["indices"]
    except (AttributeError, KeyError, TypeError):
        raise UsageError(f"mesh: is a {type(mesh).__name__}; give an open3d.t.geometry.TriangleMesh, or positions and indices") from None


def _host(name: str, value: Any) -> Any:
    """A tensor of Open3D as the NumPy array that shares its memory; NumPy's from_dlpack takes 1 s for a million rays."""
    if not hasattr(value.__class__, "from_numpy"):
        return value
    try:
        return value.numpy()
    except RuntimeError as error:
        raise UsageError(f"{name}: not in host memory ({error}); copy it there by cpu()") from None


def _maker(*arguments: Any) -> Callable[[NDArray[Any]], Any]:
    """What turns a contiguous array into a result of the arguments' kind."""
    makers = (getattr(value.__class__, "from_numpy", None) for value in arguments)  # that of open3d.core.Tensor
    return next(filter(None, makers), _viewed)


def _viewed(array: NDArray[Any]) -> Array:
    return array.view(Array)


def _in_kind(arrays: dict[str, NDArray[Any]], shape: Shape, argument: Any) -> dict[str, Any]:
    make = _maker(argument)
    return {name: make(np.ascontiguousarray(array).reshape(*shape, *array.shape[1:])) for name, array in arrays.items()}


def _directions(count: int) -> NDArray[np.float32]:
    """The directions along which Open3D counts crossings (VoteInsideOutside in RaycastingScene.cpp): (1, 1, 1), each number
    off by up to 0.001, of a Mersenne Twister with the seed 42. They matter only where surfaces are open."""
    draws = np.random.RandomState(42).randint(0, 2**32, (count, 3), dtype=np.uint32).astype(np.float32) * np.float32(2.0**-32)
    return np.float32(1) + (draws * np.float32(0.002) - np.float32(0.001))


def _numbers(name: str, value: ArrayLike, shape: Shape) -> NDArray[np.float64]:
    array = as_array(name, _host(name, value))
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise UsageError(f"{name}: has dtype {array.dtype} and shape {array.shape}; use numbers of shape {shape}")
    return array.astype(np.float64)


def _rays_of_matrices(intrinsic_matrix: Any, extrinsic_matrix: Any, width_px: int, height_px: int) -> NDArray[np.float32]:
    camera = _numbers("intrinsic_matrix", intrinsic_matrix, (3, 3))
    world = _numbers("extrinsic_matrix", extrinsic_matrix, (4, 4))
    if np.linalg.det(camera) == 0:
        raise UsageError("intrinsic_matrix: is singular; give focal lengths other than 0")
    back = world[:3, :3].T
    towards = (back @ np.linalg.inv(camera)).astype(np.float32)
    rays = np.empty((height_px, width_px, 6), np.float32)
    rays[..., :3] = -back @ world[:3, 3]
    x, y = np.meshgrid(np.arange(width_px, dtype=np.float32) + np.float32(0.5), np.arange(height_px, dtype=np.float32) + np.float32(0.5))
    rays[..., 3:] = np.stack([x, y, np.ones_like(x)], axis=-1) @ towards.T
    return rays


def _rays_of_view(fov_deg: float, center: Any, eye: Any, up: Any, width_px: int, height_px: int) -> NDArray[np.float32]:
    place = _numbers("eye", eye, (3,))
    forward = _numbers("center", center, (3,)) - place
    right = np.cross(_numbers("up", up, (3,)), forward)
    if not np.linalg.norm(right) > 0:
        raise UsageError("up: is parallel to the view; use another direction")
    forward, right = forward / np.linalg.norm(forward), right / np.linalg.norm(right)
    focal = 0.5 * width_px / np.tan(0.5 * np.radians(number("fov_deg", fov_deg)))
    extrinsic = np.eye(4)
    extrinsic[:3, :3] = right, np.cross(forward, right), forward
    extrinsic[:3, 3] = -extrinsic[:3, :3] @ place
    return _rays_of_matrices([[focal, 0, 0.5 * width_px], [0, focal, 0.5 * height_px], [0, 0, 1]], extrinsic, width_px, height_px)
