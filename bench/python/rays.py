"""Rays from Python: against trimesh with embreex in this process, and against C++ (bench_host_rays) on the same rays.

    python bench/python/rays.py SCENE.obj [--rays N] [--rounds N] [--cpp build/bin/bench_host_rays] [--csv FILE]

Prints medians in milliseconds, ratios of medians, and wrong hits among N rays that aim at edges and vertices: rays from
inside a closed mesh that leave it, and rays from outside that pass through a front face.
"""

import argparse
import csv
import subprocess
import tempfile
import time

import numpy as np
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

import claray
import claray.trimesh


def medians(rounds, tasks, clock=time.perf_counter):
    """The median time of each task, in milliseconds; tasks take turns."""
    times = {name: [] for name in tasks}
    for turn in range(rounds + 1):  # the first is a warm-up
        for name, task in tasks.items():
            begin = clock()
            task()
            if turn:
                times[name].append(1e3 * (clock() - begin))
    return {name: float(np.median(values)) for name, values in times.items()}


def rays_in_order(mesh, count):
    """Camera rays, row by row."""
    side = int(np.sqrt(count))
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, side), np.linspace(0.5, -0.5, side))
    extent, centre = mesh.extents.max(), mesh.bounds.mean(axis=0)
    eye = centre + np.array([0.0, 0.1, 2.0]) * extent
    targets = centre + extent * np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    return np.broadcast_to(eye, targets.shape).copy(), targets - eye


def rays_in_random_order(mesh, count, rng):
    """Rays from all sides, each towards a point of a sphere within the mesh's box."""
    extent, centre = mesh.extents.max(), mesh.bounds.mean(axis=0)
    origins = centre + extent * on_sphere(count, rng)
    return origins, centre + 0.5 * extent * on_sphere(count, rng) - origins


def on_sphere(count, rng):
    points = rng.normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def points_of_edges(mesh, count, rng):
    """Points on edges, every fourth one a vertex, and the edges' numbers in mesh.face_adjacency."""
    edges = rng.integers(len(mesh.face_adjacency_edges), size=count)
    ends = mesh.vertices[mesh.face_adjacency_edges[edges]]
    share = rng.random((count, 1))
    share[::4] = 0
    return (1 - share) * ends[:, 0] + share * ends[:, 1], edges


def wrong_from_inside(first, mesh, count, rng):
    """Rays from inside the closed mesh that leave it."""
    points, _ = points_of_edges(mesh, count, rng)
    inside = mesh.bounds.mean(axis=0) + 0.02 * mesh.extents.max() * on_sphere(count, rng)
    return int((first(inside, points - inside) == -1).sum())


def wrong_from_outside(hit, mesh, count, rng):
    """Rays that miss the surface at a point between two front faces, or hit behind it."""
    points, edges = points_of_edges(mesh, count, rng)
    normals = mesh.face_normals[mesh.face_adjacency[edges]]
    towards = -normals.mean(axis=1)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    front = (np.einsum("ikj,ij->ik", normals, towards) < -0.2).all(axis=1)
    at_vertex = np.arange(count) % 4 == 0  # whose other faces may be turned away
    keep = front & ~at_vertex
    distance = 0.05 * mesh.extents.max()
    points, towards = points[keep], towards[keep]
    origins = points - distance * towards
    found = hit(origins, towards)
    return int((~(found <= distance * (1 + 1e-3))).sum()), int(keep.sum())


def compare_speed(mesh, options, rows):
    rng = np.random.default_rng(1)
    embree, own = RayMeshIntersector(mesh), claray.trimesh.RayMeshIntersector(mesh)
    bvh = claray.Bvh(mesh.vertices, mesh.faces, builder="high")
    for order, (origins, directions) in (("in order", rays_in_order(mesh, options.rays)),
                                         ("random", rays_in_random_order(mesh, options.rays, rng))):
        scaled = ((origins - embree._scene.origin) * embree._scene.scale).astype(np.float32)
        single, towards = origins.astype(np.float32), directions.astype(np.float32)
        packed = claray.rays(origins, directions)
        out = np.empty(len(packed), claray.HIT)
        times = medians(options.rounds, {
            "embreex": lambda: embree._scene.scene.run(scaled, towards),
            "trimesh + embreex, intersects_first": lambda: embree.intersects_first(origins, directions),
            "claray.trimesh, intersects_first": lambda: own.intersects_first(origins, directions),
            "claray.closest_hit, float64": lambda: claray.closest_hit(bvh, origins, directions),
            "claray.closest_hit, float32": lambda: claray.closest_hit(bvh, single, towards),
            "claray.closest_hit, packed rays": lambda: claray.closest_hit(bvh, packed),
            "claray.closest_hit, packed rays, out": lambda: claray.closest_hit(bvh, packed, out=out),
        })
        same = (embree.intersects_first(origins, directions) == own.intersects_first(origins, directions)).mean()
        for name, value in times.items():
            rows.append([order, name, round(value, 2), round(times["trimesh + embreex, intersects_first"] / value, 2)])
        print(f"{order}: {len(packed)} rays, {100 * same:.4f} % with the same triangle")
        if options.cpp:
            compare_with_cpp(options, order, packed, bvh, out, rows)


def compare_with_cpp(options, order, packed, bvh, out, rows):
    """C++ and Python by turns, three times."""
    ratios = {"closest_hit": [], "query": []}
    query = claray.Query(bvh)
    with tempfile.NamedTemporaryFile(suffix=".rays") as file:
        packed.tofile(file.name)
        for _ in range(3):
            printed = subprocess.run([options.cpp, options.scene, file.name, "--rounds", str(options.rounds)], check=True,
                                     capture_output=True, text=True).stdout
            of_cpp = {line.split()[0]: float(line.split()[1]) for line in printed.splitlines()}
            of_python = medians(options.rounds, {"closest_hit": lambda: claray.closest_hit(bvh, packed),
                                                 "query": lambda: query(packed, out=out)})
            for name, value in of_python.items():
                ratios[name].append(value / of_cpp[name])
    for name, values in ratios.items():
        rows.append([order, f"Python / C++, {name}", "", round(float(np.median(values)), 3)])


def compare_hits(mesh, options, rows):
    embree, own = RayMeshIntersector(mesh), claray.trimesh.RayMeshIntersector(mesh)
    bvh = claray.Bvh(mesh.vertices, mesh.faces, builder="high")

    def distance_by_embree(origins, directions):
        locations, rays, _ = embree.intersects_location(origins, directions, multiple_hits=False)
        distances = np.full(len(origins), np.inf)
        distances[rays] = np.linalg.norm(locations - origins[rays], axis=1)
        return distances

    def distance_by_claray(origins, directions):
        return claray.closest_hit(bvh, origins, directions)["t"]

    for name, engine, distance in (("trimesh + embreex", embree, distance_by_embree), ("claray", own, distance_by_claray)):
        if mesh.is_watertight:
            inside = wrong_from_inside(engine.intersects_first, mesh, options.rays, np.random.default_rng(2))
            rows.append(["edge rays from inside", name, f"{inside} of {options.rays} leave the mesh", ""])
        wrong, count = wrong_from_outside(distance, mesh, options.rays, np.random.default_rng(3))
        rows.append(["edge rays from outside", name, f"{wrong} of {count} pass through", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--cpp")
    parser.add_argument("--csv")
    parser.add_argument("--no-speed", action="store_true")
    options = parser.parse_args()
    scene = claray.load(options.scene)
    mesh = trimesh.util.concatenate([trimesh.Trimesh(m["vertices"], m["triangles"], process=False) for m in scene.meshes])
    print(f"{claray.default_device().name}; {options.scene}: {len(mesh.faces)} triangles, closed: {mesh.is_watertight}")
    rows = []
    if not options.no_speed:
        compare_speed(mesh, options, rows)
    compare_hits(mesh, options, rows)
    header = ["rays", "what", "milliseconds", "ratio"]
    for row in [header, *rows]:
        print("{:24} {:40} {:>32} {:>8}".format(*map(str, row)))
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file).writerows([header, *rows])


if __name__ == "__main__":
    main()
