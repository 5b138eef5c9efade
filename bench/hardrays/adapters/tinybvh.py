"""tinybvh, which is one header of C++: run.py takes its folder. It normalizes directions."""

import ctypes
import os
import subprocess
import tempfile

import numpy as np

PACKAGE, HEADER = "tinybvh", os.path.join(os.environ.get("HARDRAYS_TINYBVH", ""), "tiny_bvh.h")
if not os.path.exists(HEADER):
    raise FileNotFoundError("give the folder of tiny_bvh.h by --tinybvh")
LIBRARY = os.path.join(tempfile.mkdtemp(), "tinybvh.so")
COMPILER = ["c++", "-O2", "-march=native", "-shared", "-fPIC", "-I", os.path.dirname(HEADER)]
subprocess.run([*COMPILER, __file__[:-2] + "cpp", "-o", LIBRARY], check=True)
library = ctypes.CDLL(LIBRARY)
library.build.restype = ctypes.c_void_p
in_memory = lambda a: ctypes.c_void_p(a.ctypes.data)


def make(positions, triangles):
    corners = np.zeros((3 * len(triangles), 4), np.float32)
    corners[:, :3] = positions[triangles].reshape(-1, 3)
    return corners, ctypes.c_void_p(library.build(in_memory(corners), len(triangles)))


def closest_hit(scene, origins, directions):
    t, primitive = np.zeros(len(origins), np.float32), np.zeros(len(origins), np.uint32)
    library.closest_hit(scene[1], *map(in_memory, (origins, directions, t, primitive)), len(origins))
    return t < 1e30, t / np.linalg.norm(directions.astype(np.float64), axis=1), primitive
