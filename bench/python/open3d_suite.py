"""Runs Open3D's own tests of RaycastingScene with claray as the engine.

    python bench/python/open3d_suite.py FOLDER [PYTEST OPTION...]

FOLDER: a checkout of github.com/isl-org/Open3D, whose tests are not part of its package. Needs open3d and pytest.
"""

import os
import sys

import open3d
import pytest

import claray.open3d

claray.open3d.install()
created = []
original = claray.open3d.RaycastingScene.__init__


def counting(self, *arguments, **options):
    created.append(1)
    original(self, *arguments, **options)


claray.open3d.RaycastingScene.__init__ = counting
test = os.path.join(os.path.abspath(sys.argv[1]), "python/test/t/geometry/test_raycasting_scene.py")
status = pytest.main([test, "-q", "-p", "no:cacheprovider", *sys.argv[2:]])
print(f"claray was the engine of {len(created)} scenes, with Open3D {open3d.__version__}")
sys.exit(status or not created)
