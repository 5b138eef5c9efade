"""Runs trimesh's own tests that use rays or nearest points, with claray as the engine.

    python bench/python/trimesh_suite.py FOLDER [--own] [PYTEST OPTION...]

FOLDER: a checkout of github.com/mikedh/trimesh, whose tests are not part of its package. --own: with trimesh's own engines,
to see which tests fail without claray, too.
"""

import os
import re
import sys

import pytest

folder = os.path.abspath(sys.argv[1])
sys.path.insert(0, folder)  # the trimesh that the tests belong to

import trimesh.ray  # noqa: E402

import claray.trimesh  # noqa: E402

USES = re.compile(r"\.ray\b|proximity|\.nearest\b|\.contains\(|thickness|signed_distance|registration|voxelized|volume_mesh")
options, counts = sys.argv[2:], {}


def counted(owner, name):
    """Counts calls, so that a run in which claray was never asked fails."""
    original = getattr(owner, name)

    def call(*arguments, **keywords):
        counts[name] = counts.get(name, 0) + 1
        return original(*arguments, **keywords)

    setattr(owner, name, call)


if "--own" in options:
    options.remove("--own")
else:
    for method in ("intersects_id", "intersects_first", "intersects_any", "contains_points", "nearest"):
        counted(claray.trimesh.RayMeshIntersector, method)
    claray.trimesh.install()
tests = []
for name in sorted(os.listdir(os.path.join(folder, "tests"))):
    path = os.path.join(folder, "tests", name)
    if name.startswith("test_") and name.endswith(".py") and USES.search(open(path, encoding="utf-8").read()):
        tests.append(path)
print("of", len(tests), "files:", " ".join(os.path.basename(t)[5:-3] for t in tests), flush=True)
status = pytest.main([*tests, "-q", "-p", "no:cacheprovider", *options])
print("calls of claray:", counts)
sys.exit(status or ("--own" not in sys.argv and not {"intersects_id", "nearest"} <= counts.keys()))
