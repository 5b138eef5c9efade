"""Without bpy (Blender as a module, of PyPI) these tests are skipped, and say so: it exists for one version of Python."""

import pytest

pytest.importorskip("bpy", reason="PyPI's bpy is not installed: tests/blender/run installs it")
pytest.importorskip("claray")
