"""The drop-ins claray.open3d and claray.warp beside Open3D and Warp on the CPU, by turns, on the same arrays.

    python bench/python/drop_ins.py SCENE.obj [--rounds N]

1,000,000 rays in order, and 100,000 points around the mesh. Times are of processors, medians in milliseconds; the last number
is the other library's time over claray's. Needs open3d, warp-lang, embreex and trimesh (bench/hardrays/peers.txt).
"""

import argparse
import time

import numpy as np
import open3d as o3d
import trimesh
import warp as wp
from rays import medians, rays_in_order

import claray.open3d
import claray.warp

wp.set_module_options({"enable_backward": False})


@wp.kernel
def trace(mesh: wp.uint64, start: wp.array[wp.vec3], dir: wp.array[wp.vec3], faces: wp.array[int], places: wp.array[wp.vec3],
          normals: wp.array[wp.vec3]):
    i = wp.tid()
    found = wp.mesh_query_ray(mesh, start[i], dir[i], 1.0e30)
    faces[i] = wp.where(found.result, found.face, -1)
    places[i] = wp.vec3(found.t, found.u, found.v)
    normals[i] = found.normal


@wp.kernel
def find(mesh: wp.uint64, points: wp.array[wp.vec3], faces: wp.array[int], places: wp.array[wp.vec3]):
    i = wp.tid()
    found = wp.mesh_query_point(mesh, points[i], 1.0e30)
    faces[i] = wp.where(found.result, found.face, -1)
    places[i] = wp.vec3(found.sign, found.u, found.v)


def report(title, own, other, rounds):
    times = medians(rounds, {"own": own, "other": other}, time.process_time)
    print(f"{title:32} {times['own']:9.1f} {times['other']:9.1f} {times['other'] / times['own']:6.2f}", flush=True)


def beside_open3d(vertices, triangles, rays, points, rounds):
    own, other = claray.open3d.RaycastingScene(), o3d.t.geometry.RaycastingScene()
    for scene in (own, other):
        scene.add_triangles(vertices, triangles)
    rays, points = o3d.core.Tensor(np.hstack(rays)), o3d.core.Tensor(points)
    for name in ("cast_rays", "test_occlusions", "count_intersections", "list_intersections"):
        report(name, lambda: getattr(own, name)(rays), lambda: getattr(other, name)(rays), rounds)
    for name in ("compute_closest_points", "compute_distance", "compute_signed_distance", "compute_occupancy"):
        report(name, lambda: getattr(own, name)(points), lambda: getattr(other, name)(points), rounds)


def beside_warp(vertices, triangles, rays, points, rounds):
    arrays = [wp.array(array, dtype=wp.vec3, device="cpu") for array in (vertices, *rays, points)]
    indices = wp.array(triangles.ravel().astype(np.int32), dtype=int, device="cpu")
    own, other = claray.warp.Mesh(arrays[0], indices), wp.Mesh(arrays[0], indices)
    _, start, towards, points = arrays

    def launch(kernel, *inputs):
        outputs = [wp.empty(len(inputs[0]), dtype=kind, device="cpu") for kind in (int, wp.vec3, wp.vec3)]
        wp.launch(kernel, len(inputs[0]), [other.id, *inputs, *outputs[:1 + len(inputs)]], device="cpu")

    report("mesh_query_ray", lambda: claray.warp.mesh_query_ray(own, start, towards, 1e30), lambda: launch(trace, start, towards), rounds)
    report("mesh_query_point", lambda: claray.warp.mesh_query_point(own, points, 1e30), lambda: launch(find, points), rounds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    mesh = trimesh.load(options.scene, process=False, force="mesh")
    vertices, triangles = np.ascontiguousarray(mesh.vertices, np.float32), np.ascontiguousarray(mesh.faces, np.uint32)
    rays = [array.astype(np.float32) for array in rays_in_order(mesh, 1_000_000)]
    low, high = mesh.bounds + 0.1 * mesh.extents * [[-1], [1]]
    points = np.random.default_rng(1).uniform(low, high, (100_000, 3)).astype(np.float32)
    print(f"{len(triangles)} triangles\n{'':32} {'claray':>9} {'other':>9} {'ratio':>6}")
    beside_open3d(vertices, triangles, rays, points, options.rounds)
    beside_warp(vertices, triangles, rays, points, options.rounds)


if __name__ == "__main__":
    main()
