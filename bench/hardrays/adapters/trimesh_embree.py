"""trimesh with embreex, which is its engine where embreex is installed."""

import numpy as np
from trimesh.ray.ray_pyembree import RayMeshIntersector

from adapters import trimesh_own

PACKAGE = "trimesh"
closest_hit = trimesh_own.closest_hit
occluded = RayMeshIntersector.intersects_any
inside = RayMeshIntersector.contains_points


def make(positions, triangles):
    return trimesh_own.make(positions, triangles, RayMeshIntersector)


def count_hits(rays, origins, directions):
    return np.bincount(rays.intersects_id(origins, directions)[1], minlength=len(origins))
