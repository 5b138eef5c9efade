"""PyVista's multi_ray_trace, which is trimesh with embreex."""

import numpy as np
import pyvista

PACKAGE = "pyvista"


def make(positions, triangles):
    return pyvista.PolyData.from_regular_faces(positions, triangles.astype(np.int64))


def closest_hit(mesh, origins, directions, trace=pyvista.PolyData.multi_ray_trace):
    places, ray, cell = trace(mesh, origins, directions, first_point=True)
    hit, t, primitive = np.zeros(len(origins), bool), np.zeros(len(origins)), np.full(len(origins), -1)
    o, d = origins[ray].astype(np.float64), directions[ray].astype(np.float64)
    hit[ray], t[ray], primitive[ray] = True, ((places - o) * d).sum(1) / (d * d).sum(1), cell
    return hit, t, primitive
