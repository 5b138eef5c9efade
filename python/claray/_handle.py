"""What claray's objects share."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import Any, NoReturn

_PACKAGE = str(Path(__file__).parent)


class Handle:
    """An object that stands for memory of a device or of the library.

    Properties that its class does not have are refused, since setting them would have no effect. So is pickling; the
    message says what to pass instead.
    """

    __slots__ = ("__weakref__",)
    _instead_of_pickling = "make it in each process"

    def __setattr__(self, name: str, value: Any) -> None:
        try:
            object.__setattr__(self, name, value)
        except AttributeError:
            of_class = getattr(type(self), name, None)
            raise AttributeError(f"claray.{type(self).__name__}.{name}: " + (
                "cannot be set" if of_class is not None else f"there is no such property; it has {_names(type(self))}")) from None

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise TypeError(f"a claray.{type(self).__name__} can neither be pickled nor copied by copy(): {self._instead_of_pickling}")


def _names(of: type) -> str:
    return ", ".join(name for name in dir(of) if not name.startswith("_") and not callable(getattr(of, name)))


def warn(text: str) -> None:
    """Warns at the line outside of the package that called it."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame, level = frame.f_back, level + 1
    warnings.warn(text, stacklevel=level)
