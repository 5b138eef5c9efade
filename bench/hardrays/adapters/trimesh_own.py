"""trimesh's own engine, which is in NumPy, and its nearest points."""

import numpy as np
import trimesh
from trimesh.ray.ray_triangle import RayMeshIntersector

PACKAGE, MOST = "trimesh", 5_000


def make(positions, triangles, engine=RayMeshIntersector):
    return engine(trimesh.Trimesh(positions, triangles))


def closest_hit(rays, origins, directions):
    primitive, ray, places = rays.intersects_id(origins, directions, multiple_hits=False, return_locations=True)
    hit, t, found = np.zeros(len(origins), bool), np.zeros(len(origins)), np.full(len(origins), -1)
    o, d = origins[ray].astype(np.float64), directions[ray].astype(np.float64)
    hit[ray], t[ray], found[ray] = True, ((places - o) * d).sum(1) / (d * d).sum(1), primitive
    return hit, t, found


def distance(rays, points):
    return trimesh.proximity.closest_point(rays.mesh, points)[1]


def inside(rays, points):
    return rays.contains_points(points)
