"""claray's interface of PyVista."""

import claray.pyvista

from adapters import pyvista as own

PACKAGE, make = "claray", own.make


def closest_hit(mesh, origins, directions):
    return own.closest_hit(mesh, origins, directions, claray.pyvista.multi_ray_trace)


def occluded(mesh, origins, directions):
    return closest_hit(mesh, origins, directions)[0]
