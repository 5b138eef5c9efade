"""point-cloud-utils: Embree for rays, fast winding numbers for signs."""

import numpy as np
import point_cloud_utils as pcu

PACKAGE = "point-cloud-utils"


def make(positions, triangles):
    return positions, triangles.astype(np.int32)


def closest_hit(mesh, origins, directions):
    primitive, _, t = pcu.ray_mesh_intersection(*mesh, origins, directions)
    return np.isfinite(t), t, primitive


def distance(mesh, points):
    return pcu.closest_points_on_mesh(points, *mesh)[0]


def inside(mesh, points):
    return pcu.signed_distance_to_mesh(points, *mesh)[0] < 0
