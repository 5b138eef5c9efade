"""How renders tell their progress: to a function, or on standard error."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Callable, Generator, Literal, Union

from ._options import RenderProgress
from .errors import UsageError

Report = Callable[[RenderProgress], Any]
Progress = Union[Report, bool, Literal["tqdm"], None]
"""A function that is called several times a second and returns False to stop; True for a bar of tqdm, or a line on standard error
without it; "tqdm" for a bar; None or False for nothing."""


@contextmanager
def reports(progress: Progress) -> Generator[Report | None, None, None]:
    """The function to call; its last call is with what was reached."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    elif progress is True or isinstance(progress, str) and progress == "tqdm":
        bar = _bar(required=progress is not True)
        try:
            yield bar
        finally:
            bar.close()
    else:
        raise UsageError(f"progress: is {progress!r}; use a function, True, 'tqdm' or None")


def _bar(required: bool) -> _Line:
    try:
        tqdm: Any = import_module("tqdm.auto").tqdm
    except ImportError:
        if required:
            raise UsageError("progress: tqdm is not installed; install it, or pass True") from None
        return _Line()
    return _TqdmBar(tqdm)


class _Line:
    """A line on standard error, which is written over."""

    def __call__(self, progress: RenderProgress) -> None:
        self.write(f"\r{progress['spp']} of {progress['spp_target']} samples per pixel, {progress['seconds']:.1f} s, "
                   f"noise {progress['noise']:.3f}")

    def write(self, text: str) -> None:
        sys.stderr.write(text)
        sys.stderr.flush()

    def close(self) -> None:
        self.write("\n")


class _TqdmBar(_Line):
    def __init__(self, tqdm: Any) -> None:
        self._bar = tqdm(unit="spp")

    def __call__(self, progress: RenderProgress) -> None:
        self._bar.total = progress["spp_target"]
        self._bar.set_postfix(noise=f"{progress['noise']:.3f}", refresh=False)
        self._bar.update(progress["spp"] - self._bar.n)

    def close(self) -> None:
        self._bar.close()
