"""Embree 4 by embreex, which traces ray by ray on the caller's thread."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

import adapters.embreex as adapter
from tracers import best, cores

PACKAGE, BEST = "embreex", "rays in parts, by a thread for each core"
threads = ThreadPoolExecutor(cores)
one_ray = np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32)


def make(positions, triangles):
    scene = adapter.make(positions, triangles)
    scene.run(*one_ray)  # builds the tree
    return scene


def closest(scene, origins, directions, coherent):
    return task(scene, origins, directions, 1e30, "INTERSECT")


def any_hit(scene, origins, directions, coherent):
    return task(scene, origins, directions, 1.0, "OCCLUDED")


def task(scene, origins, directions, tmax, query):
    rays = origins, directions, np.full(len(origins), tmax, np.float32)
    parts = list(zip(*(np.array_split(a, 8 * cores if best else 1) for a in rays)))
    trace = lambda part: scene.run(part[0], part[1], dists=part[2], query=query)
    return (lambda: list(threads.map(trace, parts))) if best else lambda: [trace(parts[0])]


def count(found):
    return sum(int(np.count_nonzero(part != -1)) for part in found)
