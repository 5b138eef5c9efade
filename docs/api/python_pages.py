"""The reference of the Python package, by pdoc: python_pages.py FOLDER. Each warning is an error."""

from __future__ import annotations

import re
import sys
import warnings
from pathlib import Path
from typing import Generic, NewType, TypeVar

import numpy.typing
import pdoc
from pdoc import docstrings

# pdoc writes what an alias stands for: 400 characters for each array.
Element = TypeVar("Element")
ArrayLike = NewType("ArrayLike", object)


class NDArray(Generic[Element]):
    """Stands for numpy.typing.NDArray."""


ArrayLike.__module__ = NDArray.__module__ = "numpy.typing"
numpy.typing.ArrayLike, numpy.typing.NDArray = ArrayLike, NDArray  # type: ignore[misc,assignment]

convert = docstrings.convert


def with_lists(text: str, docformat: str, source: Path | None) -> str:
    """A line of a docstring that begins with names and a colon becomes an element of a list."""
    lines, in_list = [], False
    for line in text.splitlines():
        named = re.match(r"([a-z_]+(, [a-z_]+)*): ", line)
        if named and not in_list and lines and lines[-1]:
            lines.append("")
        in_list = bool(named) or in_list and bool(line)
        names = ", ".join(f"`{name}`" for name in named[1].split(", ")) if named else ""
        lines.append(f"- {names}: {line[named.end():]}" if named else "  " + line if in_list else line)
    return convert("\n".join(lines), docformat, source)


docstrings.convert = with_lists
warnings.simplefilter("error")
pdoc.render.configure(show_source=False)
pdoc.pdoc("claray", "claray.open3d", "claray.sensors", "claray.trimesh", "claray.trimesh.proximity", "claray.warp", output_directory=Path(sys.argv[1]))
