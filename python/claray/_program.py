"""The program claray, which a wheel brings as a command."""

from __future__ import annotations

import os
import sys

from . import _loader


def main() -> None:
    """Becomes the program. It sees the loader and the drivers that the package found."""
    here = os.path.dirname(__file__)
    program = os.path.join(here, "bin", "claray")
    if not os.path.exists(program):
        sys.exit("claray: this build of the package has no program; build it with CMake, or install a wheel")
    if _loader.of_wheel:
        paths = [os.environ.get("LD_LIBRARY_PATH", ""), os.path.join(here, "loader")]
        os.environ["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, paths))
    os.execv(program, ["claray", *sys.argv[1:]])
