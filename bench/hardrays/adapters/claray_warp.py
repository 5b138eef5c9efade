"""claray by claray.warp, which has Warp's queries of meshes. The sign is that of mesh_query_point_sign_normal."""

import numpy as np
from claray import warp

PACKAGE, LIMITS = "claray", ("tmax",)
make = warp.Mesh


def closest_hit(mesh, origins, directions, tmax=np.inf):
    found = warp.mesh_query_ray(mesh, origins, directions, tmax)
    return found.result, found.t, found.face


occluded = lambda mesh, o, d: warp.mesh_query_ray_anyhit(mesh, o, d, np.inf)
count_hits = warp.mesh_query_ray_count_intersections
inside = lambda mesh, points: warp.mesh_query_point_sign_normal(mesh, points, np.inf).sign < 0


def distance(mesh, points):
    near = warp.mesh_query_point_no_sign(mesh, points, np.inf)
    return np.linalg.norm(warp.mesh_eval_position(mesh, near.face, near.u, near.v) - points, axis=1)
