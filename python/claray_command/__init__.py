"""The command `claray` of a wheel. It stands beside the package, whose import would load NumPy first."""

from __future__ import annotations

import importlib.util
import os
import sys


def main() -> None:
    """Becomes the program. It sees the loader and the drivers that the package would use."""
    package = os.path.join(os.path.dirname(os.path.dirname(__file__)), "claray")
    program = os.path.join(package, "bin", "claray")
    if not os.path.exists(program):
        sys.exit("claray: this build of the package has no program; build it with CMake, or install a wheel")
    specification = importlib.util.spec_from_file_location("claray_loader", os.path.join(package, "_loader.py"))
    assert specification is not None and specification.loader is not None
    loader = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(loader)
    if loader.of_wheel:
        paths = [os.environ.get("LD_LIBRARY_PATH", ""), os.path.join(package, "loader")]
        os.environ["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, paths))
    os.execv(program, ["claray", *sys.argv[1:]])
