"""What a caller of arrays pays: builds, and closest hits of few and of many rays, beside embreex and Open3D, by turns.

    python bench/python/queries.py [SCENE.obj...] [--rounds N] [--csv FILE]

A ball of 5,120 triangles, and the scenes. All have the same arrays, and the answers are checked to be as many hits. Times are of
processors, medians, with claray's default device and builder. Needs claray, embreex, open3d and trimesh (bench/league/peers.txt).
"""

import argparse
import csv
import os
import time

import embreex.rtcore
import numpy as np
import open3d
import trimesh
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

import claray
from rays import medians, rays_in_order, rays_in_random_order

MANY = 1_000_000
COLUMNS = ("scene", "triangles", "task", "count", "claray_milliseconds", "embreex_milliseconds", "open3d_milliseconds")


class Claray:
    def __init__(self, points, triangles):
        self.bvh = claray.Bvh(points, triangles)
        self.bvh.device.finish()

    def hits(self, rays):
        return int(np.count_nonzero(claray.closest_hit(self.bvh, *rays)["primitive"] != claray.MISS))


class Embreex:
    device = embreex.rtcore.EmbreeDevice()

    def __init__(self, points, triangles):
        self.scene = EmbreeScene(self.device)
        self.mesh = TriangleMesh(self.scene, points[triangles])
        self.scene.run(points[:1], points[:1] + 1)  # which builds

    def hits(self, rays):
        return int(np.count_nonzero(self.scene.run(*rays, output=True)["primID"] >= 0))


class Open3d:
    def __init__(self, points, triangles):
        self.scene = open3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(points, triangles)
        self.scene.cast_rays(np.zeros((1, 6), np.float32))  # which builds

    def hits(self, rays):
        found = self.scene.cast_rays(np.concatenate(rays, 1))["primitive_ids"].numpy()
        return int(np.count_nonzero(found != open3d.t.geometry.RaycastingScene.INVALID_ID))


LIBRARIES = (Claray, Embreex, Open3d)


def report(rows, name, triangles, task, count, tasks, rounds):
    times = list(medians(rounds, dict(zip(LIBRARIES, tasks)), time.process_time).values())
    rows.append((name, triangles, task, count, *(f"{x:.4g}" for x in times)))
    print(f"{name:12} {task:9} {count:8}: claray {times[0]:9.3f} ms, embreex {times[1]:9.3f} ({times[1] / times[0]:.2f}), "
          f"Open3D {times[2]:9.3f} ({times[2] / times[0]:.2f})", flush=True)


def compare(name, mesh, rounds, rows):
    points, triangles = np.ascontiguousarray(mesh.vertices, np.float32), np.ascontiguousarray(mesh.faces, np.uint32)
    report(rows, name, len(triangles), "build", len(triangles), [lambda c=c: c(points, triangles) for c in LIBRARIES], rounds)
    built = [c(points, triangles) for c in LIBRARIES]
    random = [("random", rays_in_random_order(mesh, count, np.random.default_rng(1))) for count in (100, 1000, 10_000, MANY)]
    for task, rays in [*random, ("in order", rays_in_order(mesh, MANY))]:
        rays = [array.astype(np.float32) for array in rays]
        found = [one.hits(rays) for one in built]
        if max(found) - min(found) > 1e-3 * len(rays[0]) + 1:
            print(f"{name}, {task}: {found} hits")
        report(rows, name, len(triangles), task, len(rays[0]), [lambda one=one: one.hits(rays) for one in built], rounds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--csv")
    options = parser.parse_args()
    ball = trimesh.creation.icosphere(subdivisions=4)
    meshes = [("ball", ball)] + [(os.path.splitext(os.path.basename(path))[0], trimesh.load(path, process=False, force="mesh")) for path in options.scenes]
    rows = []
    for name, mesh in meshes:
        compare(name, mesh, options.rounds, rows)
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
