"""claray by claray.open3d, which has the interface of Open3D's RaycastingScene."""

import numpy as np
from claray.open3d import RaycastingScene

PACKAGE = "claray"


def make(positions, triangles):
    scene = RaycastingScene()
    scene.add_triangles(positions, triangles)
    return scene


def closest_hit(scene, origins, directions):
    found = scene.cast_rays(np.hstack([origins, directions]))
    return np.isfinite(found["t_hit"]), found["t_hit"], found["primitive_ids"]


occluded = lambda scene, o, d: scene.test_occlusions(np.hstack([o, d]))
count_hits = lambda scene, o, d: scene.count_intersections(np.hstack([o, d]))
distance = RaycastingScene.compute_distance
inside = lambda scene, points: scene.compute_occupancy(points) > 0.5
