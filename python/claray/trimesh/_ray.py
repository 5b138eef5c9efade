"""trimesh.ray.RayMeshIntersector with claray as the engine."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import Trimesh

from .._arrays import flag, floats, integer
from .._device import AnyDevice
from ..errors import UsageError
from ._structure import Structure, library


class RayMeshIntersector:
    """Ray queries of a trimesh.Trimesh, on a device of OpenCL.

    mesh: a trimesh.Trimesh; the structure is built at the first query, and again after the mesh has changed.
    scale_to_box: accepted as trimesh's Embree engine has it; positions are always taken relative to the centre of the
    mesh; parts that are far from each other have centres of their own. device: as of claray.Bvh.
    """

    def __init__(self, mesh: Any = None, scale_to_box: bool = True, *, device: AnyDevice = None, geometry: Any = None) -> None:
        self.mesh = mesh if geometry is None else geometry
        if not isinstance(self.mesh, Trimesh):
            raise UsageError(f"mesh: is a {type(self.mesh).__name__}; use a trimesh.Trimesh")
        self._scale_to_box, self._device = scale_to_box, device
        self._cache = library.caching.Cache(id_function=self.mesh.__hash__)

    @property
    def _structure(self) -> Structure | None:
        """None for a mesh without triangles."""
        if "structure" not in self._cache:  # nor is it where the mesh has changed
            self._cache["structure"] = None if len(self.mesh.faces) == 0 else Structure(self.mesh, self._device)
        structure: Structure | None = self._cache["structure"]
        return structure

    def intersects_id(self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True,
                      max_hits: int = 100, return_locations: bool = False, **_: Any) -> tuple[NDArray[Any], ...]:
        """The triangles that rays hit.

        ray_origins, ray_directions: (n, 3). multiple_hits: all hits along a ray, or the first only. max_hits: per ray.
        Returns index_tri (m,), index_ray (m,) and, if return_locations, locations (m, 3).
        """
        origins, directions = _unit_rays(ray_origins, ray_directions)
        most = integer("max_hits", max_hits, 0, 2**32 - 1) if flag("multiple_hits", multiple_hits) else 1
        structure = self._structure
        if structure is None or len(origins) == 0:
            triangles, rays = np.zeros(0, np.int64), np.zeros(0, np.int64)
        else:
            triangles, rays = structure.hits(origins, directions, most)
        if not flag("return_locations", return_locations):
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
        structure = self._structure
        return np.full(len(origins), -1, np.int64) if structure is None else structure.first(origins, directions)

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike, **_: Any) -> NDArray[np.bool_]:
        """Whether each ray hits the mesh: (n,)."""
        origins, directions = _rays(ray_origins, ray_directions)
        structure = self._structure
        return np.zeros(len(origins), np.bool_) if structure is None else structure.any(origins, directions)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each point of (n, 3) is inside the mesh, by the parity of hits. Of a mesh that is not watertight, rays of
        several directions vote, as in trimesh."""
        structure = self._structure
        if structure is None or not self.mesh.is_watertight:
            voted: NDArray[np.bool_] = library.ray.ray_util.contains_points(self, points)
            return voted
        return structure.inside(finite_rows("points", points))

    def nearest(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
        """The nearest point of the surface for each point: see claray.trimesh.proximity.closest_point."""
        given = finite_rows("points", points)
        structure = self._structure
        if structure is None:
            raise UsageError("mesh: has no triangles, so that no point of it is nearest")
        if len(given) == 0:
            return np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int64)
        return structure.nearest(given)

    def _locations(self, origins: NDArray[Any], directions: NDArray[Any], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
        """The points of rays in the planes of triangles, in float64."""
        corners = self.mesh.triangles[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = np.einsum("ij,ij->i", normals, directions)
        to_plane = np.einsum("ij,ij->i", normals, corners[:, 0] - origins)
        distances = np.divide(to_plane, along, out=np.zeros_like(along), where=along != 0)
        places: NDArray[np.float64] = origins + distances[:, None] * directions
        return places

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key not in ("_cache", "_device")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._device = None
        self._cache = library.caching.Cache(id_function=self.mesh.__hash__)

    def __copy__(self, *_: Any) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box, device=self._device)

    def __deepcopy__(self, *_: Any) -> RayMeshIntersector:
        return self.__copy__()


def finite_rows(name: str, value: ArrayLike) -> NDArray[Any]:
    """float32 or float64 of shape (n, 3). Numbers that are not finite are errors that name the row."""
    array = floats(name, value, 3)
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(bad):
        raise UsageError(f"{name}: row {bad[0]} is {array[bad[0]]}, which is not finite; remove such rows")
    return array


def pair(first_name: str, first: ArrayLike, second_name: str, second: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    """Two arrays of shape (n, 3)."""
    arrays = finite_rows(first_name, first), finite_rows(second_name, second)
    if len(arrays[0]) != len(arrays[1]):
        raise UsageError(f"{second_name}: has {len(arrays[1])} rows, but {first_name} has {len(arrays[0])}")
    return arrays


def _rays(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    return pair("ray_origins", ray_origins, "ray_directions", ray_directions)


def _unit_rays(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    """Origins and directions of unit length, (n, 3) float64, so that distances of all rays have the mesh's unit."""
    origins, directions = (array.astype(np.float64) for array in _rays(ray_origins, ray_directions))
    lengths = np.linalg.norm(directions, axis=1, keepdims=True)
    return origins, np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 0)
