"""The types of the package and of the examples, for type checkers."""

import os
import pathlib
import subprocess
import sys

import pytest

import claray

ROOT = pathlib.Path(__file__).parents[2]


def test_mypy_finds_no_error():
    """As strict as pyproject.toml says. Tests may run in another build than that which it names."""
    pytest.importorskip("mypy")
    package = pathlib.Path(claray.__file__).parent
    paths = [package, ROOT / "python/claray_command", ROOT / "examples/python"]
    checked = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", package.parent / "mypy_cache", *paths], cwd=ROOT,
                             env=os.environ | {"MYPYPATH": str(package.parent)}, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr
