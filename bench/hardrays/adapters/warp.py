"""Warp on the CPU. The sign is that of mesh_query_point_sign_normal."""

import warp as wp

PACKAGE = "warp-lang"
make = lambda positions, triangles: wp.Mesh(wp.array(positions, dtype=wp.vec3), wp.array(triangles.astype("int32").ravel(), dtype=int))


@wp.kernel
def ask(mesh: wp.uint64, kind: int, p: wp.array[wp.vec3], d: wp.array[wp.vec3], out: wp.array[wp.vec3]):
    i = wp.tid()
    if kind == 0:
        ray = wp.mesh_query_ray(mesh, p[i], d[i], 1.0e30)
        out[i] = wp.vec3(wp.where(ray.result, 1.0, 0.0), ray.t, float(ray.face))
    elif kind == 1:
        out[i][0] = wp.where(wp.mesh_query_ray_anyhit(mesh, p[i], d[i], 1.0e30), 1.0, 0.0)
    elif kind == 2:
        out[i][0] = float(wp.mesh_query_ray_count_intersections(mesh, p[i], d[i]))
    else:
        near = wp.mesh_query_point_sign_normal(mesh, p[i], 1.0e30)
        out[i] = wp.vec3(near.sign, wp.length(wp.mesh_eval_position(mesh, near.face, near.u, near.v) - p[i]), 0.0)


def run(mesh, kind, points, directions):
    out = wp.zeros(len(points), dtype=wp.vec3)
    wp.launch(ask, len(points), [mesh.id, kind, wp.array(points, dtype=wp.vec3), wp.array(directions, dtype=wp.vec3), out])
    return out.numpy().T


closest_hit = lambda mesh, o, d: (lambda hit, t, face: (hit > 0, t, face))(*run(mesh, 0, o, d))
occluded, count_hits = lambda mesh, o, d: run(mesh, 1, o, d)[0] > 0, lambda mesh, o, d: run(mesh, 2, o, d)[0]
distance, inside = lambda mesh, p: run(mesh, 3, p, p)[1], lambda mesh, p: run(mesh, 3, p, p)[0] < 0
