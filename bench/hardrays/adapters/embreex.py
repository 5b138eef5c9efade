"""Embree 4 by embreex."""

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

PACKAGE, LIMITS = "embreex", ("tmax",)


def make(positions, triangles):
    scene = EmbreeScene()
    TriangleMesh(scene, positions, triangles.astype(np.int32))
    return scene


def closest_hit(scene, origins, directions, tmax=None):
    found = scene.run(origins, directions, dists=tmax, query="INTERSECT", output=1)
    return found["primID"] != -1, found["tfar"], found["primID"]


def occluded(scene, origins, directions):
    return scene.run(origins, directions, query="OCCLUDED") != -1
