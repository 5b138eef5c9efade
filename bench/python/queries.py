"""What a caller of arrays pays: builds, and closest hits of few and of many rays, beside embreex and Open3D, by turns.

    python bench/python/queries.py [SCENE.obj...] [--rounds N] [--csv FILE]

A ball of 5,120 triangles, a rough one of 1,310,720, and the scenes. All have the same arrays, and the answers are checked to be as many hits. Times are of
processors, medians, with claray's default device and builder. Needs claray, embreex, open3d and trimesh (bench/league/peers.txt).
"""

import argparse
import csv
import importlib
import os
import sys
import time

import numpy as np
import trimesh

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path[1:1] = [os.path.join(FOLDER, "../league"), os.path.join(FOLDER, "../hardrays")]

from rays import medians, rays_in_order, rays_in_random_order  # noqa: E402

LIBRARIES = ("claray", "embreex", "open3d")  # the league's tracers build, the adapters of the hard rays answer arrays
TRACERS = [importlib.import_module("tracers." + name) for name in LIBRARIES]
ADAPTERS = [importlib.import_module("adapters." + name) for name in LIBRARIES]
MANY = 1_000_000
COLUMNS = ("scene", "triangles", "task", "count", "claray_milliseconds", "embreex_milliseconds", "open3d_milliseconds")


def report(rows, name, triangles, task, count, tasks, rounds):
    times = list(medians(rounds, dict(zip(LIBRARIES, tasks)), time.process_time).values())
    rows.append((name, triangles, task, count, *(f"{x:.4g}" for x in times)))
    print(f"{name:12} {task:9} {count:8}: claray {times[0]:9.3f} ms, embreex {times[1]:9.3f} ({times[1] / times[0]:.2f}), "
          f"Open3D {times[2]:9.3f} ({times[2] / times[0]:.2f})", flush=True)


def compare(name, mesh, rounds, rows):
    points, triangles = np.ascontiguousarray(mesh.vertices, np.float32), np.ascontiguousarray(mesh.faces, np.uint32)
    report(rows, name, len(triangles), "build", len(triangles), [lambda t=t: t.make(points, triangles) for t in TRACERS], rounds)
    scenes = [t.make(points, triangles) for t in TRACERS]
    random = [("random", rays_in_random_order(mesh, count, np.random.default_rng(1))) for count in (100, 1000, 10_000, MANY)]
    for task, rays in [*random, ("in order", rays_in_order(mesh, MANY))]:
        rays = [array.astype(np.float32) for array in rays]
        tasks = [lambda a=a, scene=scene: int(np.count_nonzero(a.closest_hit(scene, *rays)[0])) for a, scene in zip(ADAPTERS, scenes)]
        found = [count() for count in tasks]
        if max(found) - min(found) > 1e-3 * len(rays[0]) + 1:
            print(f"{name}, {task}: {found} hits")
        report(rows, name, len(triangles), task, len(rays[0]), tasks, rounds)


def rough_ball():
    """A ball of 1,310,720 triangles with bumps."""
    ball = trimesh.creation.icosphere(subdivisions=8)
    ball.vertices *= 1 + 0.1 * np.prod(np.sin(ball.vertices * (9, 11, 13)), axis=1, keepdims=True)
    return ball


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--csv")
    options = parser.parse_args()
    meshes = [("ball", trimesh.creation.icosphere(subdivisions=4)), ("rough ball", rough_ball())] + [(os.path.splitext(os.path.basename(path))[0], trimesh.load(path, process=False, force="mesh")) for path in options.scenes]
    rows = []
    for name, mesh in meshes:
        compare(name, mesh, options.rounds, rows)
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
