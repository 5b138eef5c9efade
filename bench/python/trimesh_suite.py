"""Runs trimesh's own tests of rays with claray as the engine.

    python bench/python/trimesh_suite.py FOLDER [PYTEST OPTION...]

FOLDER: a checkout of github.com/mikedh/trimesh, whose tests are not part of its package.
"""

import os
import sys

import pytest

folder = os.path.abspath(sys.argv[1])
sys.path.insert(0, folder)  # the trimesh that the tests belong to

import trimesh.ray  # noqa: E402

import claray.trimesh  # noqa: E402

claray.trimesh.install()
created = []
original = claray.trimesh.RayMeshIntersector.__init__


def counting(self, *arguments, **options):
    created.append(1)
    original(self, *arguments, **options)


claray.trimesh.RayMeshIntersector.__init__ = counting
tests = [os.path.join(folder, "tests", name) for name in ("test_ray.py", "test_ray_upstream.py", "test_contains.py")]
status = pytest.main([*(t for t in tests if os.path.exists(t)), "-q", "-p", "no:cacheprovider", *sys.argv[2:]])
print(f"claray was the engine of {len(created)} meshes")
sys.exit(status or not created)
