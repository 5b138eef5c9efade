"""Warp on the CPU. The sign is that of mesh_query_point_sign_normal."""

import warp as wp

PACKAGE, vectors = "warp-lang", lambda values: wp.array(values, dtype=wp.vec3)
make = lambda positions, triangles: wp.Mesh(vectors(positions), wp.array(triangles.astype("int32").ravel(), dtype=int))


@wp.kernel
def ask(mesh: wp.uint64, kind: int, p: wp.array[wp.vec3], d: wp.array[wp.vec3], out: wp.array[wp.vec3]):
    i = wp.tid()
    if kind == 0:
        ray = wp.mesh_query_ray(mesh, p[i], d[i], 1.0e30)
        out[i] = wp.vec3(wp.where(ray.result, 1.0, 0.0), ray.t, float(ray.face))
    elif kind == 1:
        any_hit = wp.where(wp.mesh_query_ray_anyhit(mesh, p[i], d[i], 1.0e30), 1.0, 0.0)
        out[i] = wp.vec3(any_hit, float(wp.mesh_query_ray_count_intersections(mesh, p[i], d[i])), 0.0)
    else:
        near = wp.mesh_query_point_sign_normal(mesh, p[i], 1.0e30)
        out[i] = wp.vec3(near.sign, wp.length(wp.mesh_eval_position(mesh, near.face, near.u, near.v) - p[i]), 0.0)


def run(mesh, kind, points, directions):
    wp.launch(ask, len(points), [mesh.id, kind, vectors(points), vectors(directions), out := vectors(0 * points)])
    return out.numpy().T


closest_hit = lambda mesh, o, d: tuple(run(mesh, 0, o, d))
occluded, count_hits = lambda mesh, o, d: run(mesh, 1, o, d)[0] > 0, lambda mesh, o, d: run(mesh, 1, o, d)[1]
distance, inside = lambda mesh, p: run(mesh, 2, p, p)[1], lambda mesh, p: run(mesh, 2, p, p)[0] < 0
