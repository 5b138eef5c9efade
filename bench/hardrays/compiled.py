"""Libraries of C++ around tinybvh's one header, whose folder HARDRAYS_TINYBVH names."""

import ctypes
import os
import re
import subprocess
import tempfile


def header_of_tinybvh():
    path = os.path.join(os.environ.get("HARDRAYS_TINYBVH", ""), "tiny_bvh.h")
    if not os.path.exists(path):
        raise FileNotFoundError("give the folder of tiny_bvh.h by --tinybvh")
    return path


def version_of_tinybvh():
    with open(header_of_tinybvh(), errors="replace") as file:
        return ".".join(re.findall(r"#define TINY_BVH_VERSION_(?:MAJOR|MINOR|SUB)\s+(\d+)", file.read()))


def tinybvh(source, *options):
    header = header_of_tinybvh()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "tinybvh.so")
        command = ["c++", "-std=c++20", "-O2", "-march=native", "-shared", "-fPIC", "-I", os.path.dirname(header), source, "-o", path]
        subprocess.run([*command, *options], check=True)
        library = ctypes.CDLL(path)
    library.build.restype = ctypes.c_void_p
    return library


def in_memory(array):
    return ctypes.c_void_p(array.ctypes.data)
