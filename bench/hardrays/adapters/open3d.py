"""Open3D's RaycastingScene, which uses Embree."""

import numpy as np
import open3d as o3d

PACKAGE = "open3d"


def make(positions, triangles):
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(positions, triangles)
    return scene


def closest_hit(scene, origins, directions):
    found = scene.cast_rays(np.hstack([origins, directions]))
    t = found["t_hit"].numpy()
    return np.isfinite(t), t, found["primitive_ids"].numpy()


def occluded(scene, origins, directions):
    return scene.test_occlusions(np.hstack([origins, directions])).numpy()


def count_hits(scene, origins, directions):
    return scene.count_intersections(np.hstack([origins, directions])).numpy()


distance = lambda scene, points: scene.compute_distance(points).numpy()
inside = lambda scene, points: scene.compute_occupancy(points).numpy() > 0.5
