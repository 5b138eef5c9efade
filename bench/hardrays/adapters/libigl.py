"""libigl: its Embree for rays, and its signed distance."""

import igl
import numpy as np
from igl.embree import EmbreeIntersector

PACKAGE, LIMITS = "libigl", ("tmin", "tmax")


def make(positions, triangles):
    embree = EmbreeIntersector()
    embree.init(np.asfortranarray(positions), np.asfortranarray(triangles.astype(np.int32)))
    return embree, positions.astype(np.float64), triangles.astype(np.int64)


def closest_hit(scene, origins, directions, tmin=(), tmax=()):
    limits = zip(tmin.tolist(), tmax.tolist()) if len(tmin) else [()] * len(origins)
    found = [scene[0].intersectRay_first(o, d, *limit) for o, d, limit in zip(origins, directions, limits)]
    primitive = np.array([f[0] for f in found])
    return primitive != -1, np.array([f[1] for f in found]), primitive


def count_hits(scene, origins, directions):
    return np.array([len(scene[0].intersectRay(o, d)[0]) for o, d in zip(origins, directions)])


signed = lambda scene, points: igl.signed_distance(points.astype(np.float64), *scene[1:])[0]
distance = lambda scene, points: abs(signed(scene, points))
inside = lambda scene, points: signed(scene, points) < 0
