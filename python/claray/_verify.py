"""Whether a device can be trusted."""

from __future__ import annotations

from typing import Any, Callable, Iterable

from . import _native
from ._device import AnyDevice, device_of


def verify_cases() -> list[str]:
    """The names of all cases."""
    return _native.verify_cases()


def verify(cases: Iterable[str] | None = None, *, device: AnyDevice = None, quick: bool = True, seed: int = 1,
           times: bool = False, report: Callable[[dict[str, Any]], Any] | None = None) -> list[dict[str, Any]]:
    """Tests a device and its driver with cases that break ray tracers (docs/reliability.md). All of them take minutes.

    cases: names from verify_cases(); None: all. seed: of all random rays and meshes. times: also check ratios of times.
    report: called with the result of each case; returns False to stop.
    Returns a dict for each case: name, holds (bool), checks, failures (the first wrong rays), seconds, command.
    """
    names = verify_cases() if cases is None else list(cases)
    return _native.verify(device_of(device)._native, names, quick, seed, times, report)
