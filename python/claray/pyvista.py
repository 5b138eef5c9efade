"""Rays of pyvista.PolyData with claray as the engine.

    points, rays, cells = mesh.claray.multi_ray_trace(origins, directions)

PyVista 0.48 and later find `mesh.claray` by themselves where claray is installed; `import claray.pyvista` does it elsewhere.
Needs trimesh, whose definition of hits PyVista has, too.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import Trimesh

from ._arrays import as_array, flag
from .errors import UsageError
from .trimesh import RayMeshIntersector
from .trimesh._ray import pair

pyvista: Any = importlib.import_module("pyvista")

__all__ = ["PolyDataRays", "multi_ray_trace", "ray_trace"]

_CELL = "claray's cells"
_END = 1 + 2.0**-40
"""Up to where a segment hits what its end lies on."""


@pyvista.register_dataset_accessor("claray", pyvista.PolyData)
class PolyDataRays:
    """Rays of a PolyData, as mesh.claray.

    The structure is built at the first query, and again after the mesh was modified, as mesh.GetMTime() tells. Polygons and
    strips of triangles are divided into triangles; cells in the results are those of the mesh. Lines and vertices are not
    hit, nor are cells with vertices that are not finite.
    """

    def __init__(self, mesh: Any) -> None:
        if not isinstance(mesh, pyvista.PolyData):
            raise UsageError(f"mesh: is a {type(mesh).__name__}; use a pyvista.PolyData (extract_surface() makes one)")
        self._mesh = mesh
        self._modified = -1

    def _rays(self) -> tuple[RayMeshIntersector, NDArray[np.int64]]:
        """The engine, and the cell of each of its triangles."""
        if self._modified != self._mesh.GetMTime():
            triangles, self._cells = _triangles_of(self._mesh)
            self._engine = RayMeshIntersector(Trimesh(self._mesh.points, triangles, process=False))
            self._modified = self._mesh.GetMTime()
        return self._engine, self._cells

    def multi_ray_trace(self, origins: ArrayLike, directions: ArrayLike, first_point: bool = False,
                        retry: bool = False) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Traces many rays, as pyvista.PolyData.multi_ray_trace does.

        origins, directions: (n, 3). first_point: only the first hit of each ray. retry: results are sorted by ray, as
        PyVista does with it; there is nothing to retry.

        Returns the points (m, 3), their rays (m,) and cells (m,). Without retry, all first hits come before all second
        ones. A ray through an edge or a vertex hits one of the cells there. Raises UsageError, naming the argument.
        """
        engine, cells = self._rays()
        several = not flag("first_point", first_point)
        points, rays, triangles = engine.intersects_location(*pair("origins", origins, "directions", directions),
                                                             multiple_hits=several)
        if flag("retry", retry):
            order = np.argsort(rays, kind="stable")
            points, rays, triangles = points[order], rays[order], triangles[order]
        return points, rays, cells[triangles]

    def ray_trace(self, origin: ArrayLike, end_point: ArrayLike,
                  first_point: bool = False) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Where the segment from `origin` to `end_point`, (3,) each, hits the mesh, in this order: as
        pyvista.PolyData.ray_trace does.

        Returns the points (m, 3), or with first_point the first, (3,), if there is any; and the cells (m,). For many
        segments, multi_ray_trace is faster.
        """
        begin, end = pair("origin", np.reshape(as_array("origin", origin), (1, -1)),
                          "end_point", np.reshape(as_array("end_point", end_point), (1, -1)))
        points, _, cells = self.multi_ray_trace(begin, end - begin)
        along = end - begin
        within = (points - begin) @ along[0] <= _END * float(along[0] @ along[0])
        points, cells = points[within], cells[within]
        return points[0] if flag("first_point", first_point) and len(points) else points, cells


def multi_ray_trace(mesh: Any, origins: ArrayLike, directions: ArrayLike, first_point: bool = False,
                    retry: bool = False) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """As mesh.claray.multi_ray_trace: see PolyDataRays."""
    return _of(mesh).multi_ray_trace(origins, directions, first_point, retry)


def ray_trace(mesh: Any, origin: ArrayLike, end_point: ArrayLike,
              first_point: bool = False) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """As mesh.claray.ray_trace: see PolyDataRays."""
    return _of(mesh).ray_trace(origin, end_point, first_point)


def _of(mesh: Any) -> PolyDataRays:
    return mesh.claray if isinstance(mesh, pyvista.PolyData) else PolyDataRays(mesh)


def _triangles_of(mesh: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles (T, 3), and the cell of each."""
    if mesh.is_all_triangles:
        triangles, cells = mesh.regular_faces, np.arange(int(mesh.n_cells))
    else:
        surface = pyvista.PolyData()
        surface.SetPoints(mesh.GetPoints())
        surface.SetPolys(mesh.GetPolys())
        surface.SetStrips(mesh.GetStrips())
        surface.cell_data[_CELL] = np.arange(mesh.n_verts + mesh.n_lines, mesh.n_cells)  # PolyData has them in this order
        divided = surface.triangulate()
        triangles, cells = divided.regular_faces, divided.cell_data[_CELL]
    triangles, cells = np.reshape(triangles, (-1, 3)).astype(np.int64), np.asarray(cells, np.int64)  # none: (0,)
    finite = np.isfinite(mesh.points).all(axis=1)[triangles].all(axis=1)
    return triangles[finite], cells[finite]
