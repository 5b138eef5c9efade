"""tinybvh, ray by ray on all cores; see adapters/tinybvh.py."""

import ctypes

import numpy as np

import adapters.tinybvh as adapter
from compiled import in_memory, tinybvh, version_of_tinybvh
from tracers import best, cores

PACKAGE, BEST = "tinybvh", "BVH8_CPU, its layout for AVX2"
VERSION = version_of_tinybvh()
library = tinybvh(__file__[:-2] + "cpp", *(["-DLEAGUE_BEST"] if best else []))


def make(positions, triangles):
    return adapter.make(positions, triangles, library)


def task(kernel, scene, arrays, results):
    rays = [ctypes.c_uint(n) for n in (len(arrays[0]), cores)]
    return lambda: (kernel(scene[1], *map(in_memory, arrays + results), *rays), results)[1]


def closest(scene, origins, directions, coherent):
    results = [np.zeros(len(origins), np.float32), np.zeros(len(origins), np.uint32)]
    return task(library.closest, scene, [origins, directions], results)


def any_hit(scene, origins, directions, coherent):
    lengths = np.linalg.norm(directions.astype(np.float64), axis=1).astype(np.float32)
    return task(library.any_hit, scene, [origins, directions, lengths], [np.zeros(len(origins), np.uint32)])


def count(found):
    return int(np.count_nonzero(found[0] < 1e30 if len(found) == 2 else found[0]))
