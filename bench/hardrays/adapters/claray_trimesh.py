"""claray's interface of trimesh: RayMeshIntersector and proximity."""

import claray.trimesh

from adapters import trimesh_own

PACKAGE = "claray"
closest_hit = trimesh_own.closest_hit
occluded = claray.trimesh.RayMeshIntersector.intersects_any


def make(positions, triangles):
    return trimesh_own.make(positions, triangles, claray.trimesh.RayMeshIntersector)


def distance(rays, points):
    return claray.trimesh.proximity.closest_point(rays.mesh, points)[1]


def inside(rays, points):
    return claray.trimesh.proximity.signed_distance(rays.mesh, points) >= 0
