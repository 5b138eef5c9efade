"""Warp's own answers for test_warp.py. Warp compiles kernels of files only."""

import numpy as np
import warp as wp

QUERIES = {name: number for number, name in enumerate((
    "mesh_query_point_no_sign", "mesh_query_point", "mesh_query_point_sign_normal", "mesh_query_point_sign_parity",
    "mesh_query_point_sign_winding_number"))}


@wp.kernel
def trace(mesh: wp.uint64, start: wp.array[wp.vec3], dir: wp.array[wp.vec3], most: float, result: wp.array[bool], sign: wp.array[float],
          face: wp.array[int], t: wp.array[float], u: wp.array[float], v: wp.array[float], normal: wp.array[wp.vec3]):
    i = wp.tid()
    q = wp.mesh_query_ray(mesh, start[i], dir[i], most)
    result[i] = q.result
    sign[i] = q.sign
    face[i] = q.face
    t[i] = q.t
    u[i] = q.u
    v[i] = q.v
    normal[i] = q.normal


@wp.kernel
def find(mesh: wp.uint64, number: int, point: wp.array[wp.vec3], most: float, result: wp.array[bool], sign: wp.array[float],
         face: wp.array[int], u: wp.array[float], v: wp.array[float]):
    i = wp.tid()
    q = wp.mesh_query_point_no_sign(mesh, point[i], most)
    if number == 1:
        q = wp.mesh_query_point(mesh, point[i], most)
    if number == 2:
        q = wp.mesh_query_point_sign_normal(mesh, point[i], most)
    if number == 3:
        q = wp.mesh_query_point_sign_parity(mesh, point[i], most)
    if number == 4:
        q = wp.mesh_query_point_sign_winding_number(mesh, point[i], most, 20.0, 0.5)
    result[i] = q.result
    sign[i] = q.sign
    face[i] = q.face
    u[i] = q.u
    v[i] = q.v


class Peer:
    def __init__(self, points, triangles):
        self.points = wp.array(points, dtype=wp.vec3, device="cpu")
        self.indices = wp.array(np.asarray(triangles, np.int32).ravel(), dtype=int, device="cpu")
        self.mesh = wp.Mesh(self.points, self.indices, support_winding_number=True)

    def rays(self, start, dir, most):
        kinds = bool, float, int, float, float, float, wp.vec3
        return self._launch(trace, kinds, len(start), start, dir, most)

    def points_by(self, name, point, most):
        return self._launch(find, (bool, float, int, float, float), len(point), QUERIES[name], point, most)

    def _launch(self, kernel, kinds, count, *inputs):
        outputs = [wp.zeros(count, dtype=kind, device="cpu") for kind in kinds]
        wp.launch(kernel, count, [self.mesh.id, *inputs, *outputs], device="cpu")
        return outputs
