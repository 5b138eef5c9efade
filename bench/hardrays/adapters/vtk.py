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
    return locator, mesh, abs(positions[np.isfinite(positions)]).max()


def closest_hit(scene, origins, directions):
    o, d, (locator, _, reach) = origins.astype(np.float64), directions.astype(np.float64), scene
    far, out = 2 * (reach + np.linalg.norm(o, axis=1)) / np.linalg.norm(d, axis=1), []
    share, cell, any_cell = vtk.reference(0.0), vtk.reference(0), vtk.vtkGenericCell()
    for start, end, length in zip(o, o + far[:, None] * d, far):
        hit = locator.IntersectWithLine(start, end, 0.0, share, [0.0] * 3, [0.0] * 3, vtk.reference(0), cell, any_cell)
        out.append((hit, share.get() * length, cell.get()))
    return tuple(np.array(column) for column in zip(*out))


def signed(scene, points):
    field = vtk.vtkImplicitPolyDataDistance()
    field.SetInput(scene[1])
    return np.array([field.FunctionValue(p) for p in points.astype(np.float64)])


distance, inside = lambda scene, points: abs(signed(scene, points)), lambda scene, points: signed(scene, points) < 0
