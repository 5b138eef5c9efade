"""The interfaces of trimesh.ray and trimesh.proximity with claray as the engine.

    mesh.ray = claray.trimesh.RayMeshIntersector(mesh)
    closest, distance, triangle_id = claray.trimesh.proximity.closest_point(mesh, points)

or install() for all meshes. As trimesh's engines do, a first hit may be one where the ray only touches the surface, and
rays that begin on a surface hit it. All hits of a ray are counted exactly: one that passes through an edge or a vertex
counts once, also at a border or where the ray only touches, and surfaces at the same distance count each. Whether a point
is inside of a watertight mesh is decided by claray.inside. Nearest points are those of float64.
"""

from . import proximity
from ._ray import RayMeshIntersector

__all__ = ["RayMeshIntersector", "install", "proximity"]


def install() -> None:
    """Makes claray the engine of trimesh: of the rays of all meshes that are created from now on, and of the nearest points
    and signed distances of all meshes.

    trimesh has no place where engines register themselves, so this replaces the classes and functions in its modules.
    """
    import trimesh

    for engine in ("ray_triangle", "ray_pyembree") if trimesh.ray.has_embree else ("ray_triangle",):
        setattr(getattr(trimesh.ray, engine), "RayMeshIntersector", RayMeshIntersector)
    for name in ("closest_point", "signed_distance"):
        setattr(trimesh.proximity, name, getattr(proximity, name))
