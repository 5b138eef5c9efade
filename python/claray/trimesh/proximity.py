"""The interface of trimesh.proximity with claray as the engine: nearest points, signed distances and thickness."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import trimesh.proximity
from numpy.typing import ArrayLike, NDArray
from trimesh import Trimesh

from .._arrays import check_choice, flag, integer, number
from .._device import AnyDevice
from ..errors import UsageError
from ._ray import RayMeshIntersector, finite_rows, pair
from ._structure import TOLERANCE, library

__all__ = ["ProximityQuery", "closest_point", "longest_ray", "max_tangent_sphere", "signed_distance", "thickness"]

Nearest = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]


def closest_point(mesh: Trimesh, points: ArrayLike) -> Nearest:
    """The nearest point of the surface for each point.

    points: (n, 3). Returns closest (n, 3), distance (n,) and triangle_id (n,), as float64 decides. Where several triangles
    are nearest, the one that faces the point most is returned. Triangles of no area are not found. Raises UsageError for a
    mesh without triangles.
    """
    return _engine_of(mesh).nearest(points)


def signed_distance(mesh: Trimesh, points: ArrayLike) -> NDArray[np.float64]:
    """The distance of each point to the surface, (n,): positive inside and negative outside.

    points: (n, 3). Points within 1e-8 of the surface, or of 1e-8 of the size of a mesh smaller than 1, are positive. As in
    trimesh, the normal of the nearest triangle decides the sign where it meets the point, otherwise contains_points.
    """
    return _signed_distance(_engine_of(mesh), points)


class ProximityQuery(trimesh.proximity.ProximityQuery):
    """Nearest points of a trimesh.Trimesh. device: as of claray.Bvh; None: that of mesh.ray, if it is claray's."""

    def __init__(self, mesh: Trimesh, *, device: AnyDevice = None) -> None:
        super().__init__(mesh)  # type: ignore[no-untyped-call]  # trimesh states no types
        self._engine = _engine_of(mesh) if device is None else RayMeshIntersector(mesh, device=device)

    def on_surface(self, points: ArrayLike) -> Nearest:
        """See closest_point."""
        return self._engine.nearest(points)

    def signed_distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """See signed_distance."""
        return _signed_distance(self._engine, points)


def longest_ray(mesh: Trimesh, points: ArrayLike, directions: ArrayLike) -> NDArray[np.float64]:
    """How far a ray of each point goes before it hits the mesh, (n,); inf if it hits nothing. points, directions: (n, 3).

    Hits nearer than 1e-5 do not count.
    """
    view = _View(mesh)
    lengths: NDArray[np.float64] = library.proximity.longest_ray(view, *pair("points", points, "directions", directions))
    return lengths


def max_tangent_sphere(mesh: Trimesh, points: ArrayLike, inwards: bool = True, normals: ArrayLike | None = None,
                       threshold: float = 1e-6, max_iter: int = 100) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The largest sphere at each point of the surface that touches it there and crosses no other part of it.

    points: (n, 3) on the surface. inwards: spheres are on the inside. normals: (n, 3), or None for those of the mesh.
    Returns centers (n, 3) and radii (n,). This is trimesh's method of shrinking spheres, with rays and nearest points of
    claray.
    """
    view, inside = _View(mesh), flag("inwards", inwards)
    places, towards = view.with_normals(points, normals)
    if not len(places):
        return np.zeros((0, 3)), np.zeros(0)
    centers, radii = library.proximity.max_tangent_sphere(view, places, inside, towards, number("threshold", threshold),
                                                          integer("max_iter", max_iter, 0, 2**31 - 1))
    return centers, radii


def thickness(mesh: Trimesh, points: ArrayLike, exterior: bool = False, normals: ArrayLike | None = None,
              method: Literal["max_sphere", "ray"] = "max_sphere") -> NDArray[np.float64]:
    """The thickness of the mesh at each point of its surface, (n,); outside of it, if `exterior`.

    points: (n, 3) on the surface. normals: (n, 3), or None for those of the mesh. method: "max_sphere", the diameter of
    max_tangent_sphere, or "ray", the length of a ray along the normal.
    """
    check_choice("method", method, ("max_sphere", "ray"))
    view, outside = _View(mesh), flag("exterior", exterior)
    places, towards = view.with_normals(points, normals)
    if not len(places):
        return np.zeros(0)
    diameters: NDArray[np.float64] = library.proximity.thickness(view, places, outside, towards, method)
    return diameters




class _View:
    """A mesh whose rays and nearest points are claray's, for functions of trimesh."""

    def __init__(self, mesh: Trimesh) -> None:
        self._mesh, self.ray, self.nearest = mesh, _engine_of(mesh), ProximityQuery(mesh)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._mesh, name)

    def with_normals(self, points: ArrayLike, normals: ArrayLike | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Points, and their normals: given, or those of the nearest triangles."""
        if normals is not None:
            return pair("points", points, "normals", normals)
        places = finite_rows("points", points).astype(np.float64)
        return places, self._mesh.face_normals[self.ray.nearest(places)[2]]


def _engine_of(mesh: Trimesh) -> RayMeshIntersector:
    """The engine of the mesh's rays if it is claray's, else one that the mesh keeps."""
    if not isinstance(mesh, Trimesh):
        raise UsageError(f"mesh: is a {type(mesh).__name__}; use a trimesh.Trimesh")
    if isinstance(mesh.ray, RayMeshIntersector):
        return mesh.ray
    engine: RayMeshIntersector = vars(mesh).setdefault("_claray_engine", RayMeshIntersector(mesh))
    return engine


def _signed_distance(engine: RayMeshIntersector, points: ArrayLike) -> NDArray[np.float64]:
    given = finite_rows("points", points).astype(np.float64)
    closest, distances, triangles = engine.nearest(given)
    away = np.flatnonzero(distances > TOLERANCE * min(1, engine.mesh.scale))
    normals, places, triangles = engine.mesh.face_normals[triangles[away]], given[away], triangles[away]
    above = np.einsum("ij,ij->i", places - closest[away], normals)
    with np.errstate(divide="ignore", invalid="ignore"):  # triangles of no area
        weights = library.triangles.points_to_barycentric(engine.mesh.triangles[triangles], places - above[:, None] * normals)
    faces = ((weights >= -TOLERANCE) & (weights <= 1 + TOLERANCE)).all(axis=1)
    outside = above > 0
    outside[~faces] = ~engine.contains_points(places[~faces])
    distances[away[outside]] *= -1
    return distances
