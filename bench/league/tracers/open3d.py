"""Open3D's RaycastingScene: Embree, ray by ray on all cores."""

import numpy as np

import adapters.open3d as adapter

PACKAGE, o3d = "open3d", adapter.o3d


def make(positions, triangles):
    scene = adapter.make(positions, triangles)
    scene.cast_rays(o3d.core.Tensor(np.ones((1, 6), np.float32)))  # builds the tree
    return scene


def closest(scene, origins, directions, coherent):
    rays = o3d.core.Tensor(np.hstack([origins, directions]))
    return lambda: scene.cast_rays(rays)


def any_hit(scene, origins, directions, coherent):
    rays = o3d.core.Tensor(np.hstack([origins, directions]))
    return lambda: scene.test_occlusions(rays, tfar=1.0)


def count(found):
    return int(np.count_nonzero(np.isfinite(found["t_hit"].numpy()) if isinstance(found, dict) else found.numpy()))
