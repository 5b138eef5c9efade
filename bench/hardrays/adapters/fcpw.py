"""fcpw on the CPU: a vectorized BVH by its surface area heuristic."""

import fcpw
import numpy as np

PACKAGE, LIMITS = "fcpw", ("tmax",)


def make(positions, triangles):
    scene = fcpw.scene_3D()
    scene.set_object_count(1)
    scene.set_object_vertices(positions, 0)
    scene.set_object_triangles(triangles.astype(np.int32), 0)
    scene.build(fcpw.aggregate_type.bvh_surface_area, True)
    return scene


def closest_hit(scene, origins, directions, tmax=None):
    found, far = fcpw.interaction_3D_list(), np.full(len(origins), np.inf, np.float32) if tmax is None else tmax
    scene.intersect(np.asfortranarray(origins), np.asfortranarray(directions), far, found)
    primitive = np.array([i.primitive_index for i in found], np.int64)
    return primitive != -1, np.array([i.d for i in found]), primitive


def distance(scene, points):
    found = fcpw.interaction_3D_list()
    scene.find_closest_points(np.asfortranarray(points), np.full(len(points), np.inf, np.float32), found)
    return np.array([i.d for i in found])
