"""What accuracy costs in time."""

from __future__ import annotations

from typing import Any, Callable

from . import _native
from ._device import AnyDevice, device_of
from ._handle import Handle
from ._options import config_of
from ._scene import Scene
from .errors import UsageError


class Study(Handle):
    """Error and seconds for every setting of a method, measured on one device. Notebooks show it as a plot."""

    __slots__ = ("_native", "_subtitle")
    _instead_of_pickling = "take its points, which are dicts, or its svg()"

    def __init__(self, native: Any, subtitle: str) -> None:
        self._native, self._subtitle = native, subtitle

    @property
    def name(self) -> str:
        return str(self._native.name)

    @property
    def title(self) -> str:
        return str(self._native.title)

    @property
    def points(self) -> list[dict[str, Any]]:
        """method, setting, value, runs, error and seconds (lower quartile, median, upper quartile), front (no other point
        is both faster and more accurate), failure, facts."""
        points: list[dict[str, Any]] = self._native.points()
        return points

    @property
    def findings(self) -> list[str]:
        """Conclusions in words."""
        findings: list[str] = self._native.findings
        return findings

    def svg(self) -> str:
        """The plot as SVG: error and seconds, both logarithmic."""
        return str(self._native.svg(self._subtitle))

    def _repr_svg_(self) -> str:
        return self.svg()

    def __repr__(self) -> str:
        return f"<claray.Study '{self.name}' of {len(self.points)} points>"


def studies() -> list[str]:
    """The names of all studies."""
    return _native.study_names()


def accuracy(scene: Scene, study: str = "sampling", *, device: AnyDevice = None, most_spp: int = 256, runs: int = 5,
             rays: int = 1 << 18, width: int = 128, height: int = 128,
             progress: Callable[[float, str], Any] | None = None, **options: Any) -> Study:
    """Measures what accuracy costs in time; docs/accuracy.md describes the studies. May take minutes.

    study: one of studies(). most_spp: the largest number of samples per pixel; settings double up to it. runs: per
    setting, each with its own seed. rays: of studies without images. progress: called with the share done (0 to 1) and
    the current step; returns False to stop, which raises InputError.
    """
    if not isinstance(scene, Scene):
        raise UsageError(f"scene: is a {type(scene).__name__}; use a claray.Scene")
    native = _native.NativeStudyOptions()
    native.config = config_of({"width": width, "height": height, **options})
    for key, value in (("most_spp", most_spp), ("runs", runs), ("rays", rays)):
        if not isinstance(value, int) or value < 1:
            raise UsageError(f"{key}: is {value!r}; use a positive integer")
        setattr(native, key, value)
    on = device_of(device)
    return Study(_native.run_study(on._native, scene._native, study, native, progress), on.name)
