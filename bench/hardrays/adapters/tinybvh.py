"""tinybvh, which is one header of C++: run.py takes its folder. It normalizes directions."""

import ctypes

import numpy as np

from compiled import in_memory, tinybvh, version_of_tinybvh

PACKAGE, VERSION = "tinybvh", version_of_tinybvh()
library = tinybvh(__file__[:-2] + "cpp")


def make(positions, triangles, library=library):
    corners = np.zeros((3 * len(triangles), 4), np.float32)
    corners[:, :3] = positions[triangles].reshape(-1, 3)
    return corners, ctypes.c_void_p(library.build(in_memory(corners), len(triangles)))


def closest_hit(scene, origins, directions):
    t, primitive = np.zeros(len(origins), np.float32), np.zeros(len(origins), np.uint32)
    library.closest_hit(scene[1], *map(in_memory, (origins, directions, t, primitive)), len(origins))
    return t < 1e30, t / np.linalg.norm(directions.astype(np.float64), axis=1), primitive
