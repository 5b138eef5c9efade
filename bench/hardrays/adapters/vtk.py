"""VTK: vtkStaticCellLocator for rays, which are segments that end behind the mesh, and vtkImplicitPolyDataDistance."""

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

PACKAGE = "vtk"


def make(positions, triangles):
    points, cells, mesh, locator = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData(), vtk.vtkStaticCellLocator()
    points.SetData(numpy_to_vtk(positions, deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(triangles.astype(np.int64).ravel(), deep=True))
    mesh.SetPoints(points), mesh.SetPolys(cells), locator.SetDataSet(mesh), locator.BuildLocator()
    return locator, vtk.vtkImplicitPolyDataDistance(input=mesh), abs(positions[np.isfinite(positions)]).max()


def closest_hit(scene, origins, directions):
    o, d, (locator, _, reach) = origins.astype(np.float64), directions.astype(np.float64), scene
    size, out = reach + np.linalg.norm(o, axis=1), []
    far, close = 2 * size / np.linalg.norm(d, axis=1), 1e-12 * size
    share, cell, any_cell = vtk.reference(0.0), vtk.reference(0), vtk.vtkGenericCell()
    for start, end, length, tolerance in zip(o, o + far[:, None] * d, far, close):
        hit = locator.IntersectWithLine(start, end, tolerance, share, [0.0] * 3, [0.0] * 3, vtk.reference(0), cell, any_cell)
        out.append((hit, share.get() * length, cell.get()))
    return tuple(np.array(column) for column in zip(*out))


distance = lambda scene, points: np.array([abs(scene[1].FunctionValue(p)) for p in points.astype(np.float64)])
inside = lambda scene, points: np.array([scene[1].FunctionValue(p) < 0 for p in points.astype(np.float64)])
