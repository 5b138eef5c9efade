"""Warp on the CPU, where kernels run on one thread."""

import numpy as np
import warp as wp

from adapters.warp import vectors
from tracers import best

PACKAGE, BEST = "warp-lang", "leaves of one triangle, no backward pass, recorded launches"
wp.set_module_options({"enable_backward": not best})


@wp.kernel
def trace(mesh: wp.uint64, o: wp.array[wp.vec3], d: wp.array[wp.vec3], distances: wp.array[float], faces: wp.array[int]):
    i = wp.tid()
    found = wp.mesh_query_ray(mesh, o[i], d[i], 1.0e30)
    distances[i] = found.t
    faces[i] = wp.where(found.result, found.face, -1)


@wp.kernel
def occlude(mesh: wp.uint64, o: wp.array[wp.vec3], d: wp.array[wp.vec3], distances: wp.array[float], faces: wp.array[int]):
    i = wp.tid()
    faces[i] = wp.where(wp.mesh_query_ray_anyhit(mesh, o[i], d[i], 1.0), 0, -1)


def make(positions, triangles):
    return wp.Mesh(vectors(positions), wp.array(triangles.astype("int32").ravel(), dtype=int), bvh_leaf_size=1 if best else None)


def task(kernel, mesh, origins, directions):
    count, faces = len(origins), wp.zeros(len(origins), dtype=int)
    inputs = [mesh.id, vectors(origins), vectors(directions), wp.zeros(count, dtype=float), faces]
    recorded = wp.launch(kernel, count, inputs, record_cmd=True) if best else None
    return lambda: (recorded.launch() if best else wp.launch(kernel, count, inputs), faces)[1]


closest = lambda mesh, origins, directions, coherent: task(trace, mesh, origins, directions)
any_hit = lambda mesh, origins, directions, coherent: task(occlude, mesh, origins, directions)
count = lambda faces: int(np.count_nonzero(faces.numpy() != -1))
