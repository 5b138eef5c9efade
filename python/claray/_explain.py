"""What the effects of a scene cost."""

from __future__ import annotations

from typing import Any, Callable, Sequence, TypedDict, cast, get_args

from . import _native
from ._arrays import flag, integer, names_of
from ._device import AnyDevice, device_of
from ._options import Approximation, RenderOptions, config_of
from ._render import native_scene
from ._scene import Scene
from ._typing import Unpack
from .errors import UsageError

_APPROXIMATIONS: tuple[str, ...] = get_args(Approximation)


class Variant(TypedDict):
    """A renderer of the scene for one set of effects: device time of a frame of one sample per pixel, time to compile, registers
    and spilled bytes of the shading kernel (None: unknown), and device memory."""

    milliseconds: float
    compile_milliseconds: float
    registers: int | None
    spill_bytes: int | None
    bytes: int


class ExplainedEffect(TypedDict):
    """effect: its name. used: whether the scene uses it, and by how many objects (count), such as `first`. measured: False for what nothing
    can replace. other: the scene without it, or with it compiled in though nothing uses it; own_compile_milliseconds: of the same
    kernels as compiled for the scene. ratio: time of `other` over that of the scene's own kernels. noise: the rounds disagree which
    is slower."""

    effect: str
    used: bool
    first: str
    count: int
    measured: bool
    ratio: float
    noise: bool
    other: Variant
    own_compile_milliseconds: float


class ExplainedApproximation(TypedDict):
    """ratio: time of a frame with it over that without. noise: the rounds disagree. error: RMSE of its image over the mean."""

    approximation: str
    ratio: float
    noise: bool
    error: float


class Explanation(TypedDict):
    """own: what the scene uses and nothing else; each effect; and the approximations that have an effect in this scene."""

    own: Variant
    effects: list[ExplainedEffect]
    approximations: list[ExplainedApproximation]


def explain(scene: Scene, *, device: AnyDevice = None, only: str | Sequence[str] | None = None, rounds: int = 7,
            compile_times: bool = False, progress: Callable[[str], Any] | None = None, **options: Unpack[RenderOptions]) -> Explanation:
    """Measures what each effect of a scene costs, as the program's `claray explain`: renders with and without it, by turns. May take
    minutes. Scene.effects() tells, at once, which effects a scene uses.

    only: names of effects and approximations to measure; None: those that the scene uses. rounds: pairs of renders for each. compile_times: compile
    all kernels once more for their time. progress: called with what is done next. options: as of Renderer.
    """
    native = native_scene(scene)
    scene.validate()
    turns, times = integer("rounds", rounds, 1, 1000), flag("compile_times", compile_times)
    effects, approximations = _divided(None if only is None else names_of("only", only))
    if progress is not None and not callable(progress):
        raise UsageError(f"progress: is {progress!r}; use a function or None")
    config = config_of({"width": 128, "height": 128, **options})
    return cast(Explanation, _native.explain(device_of(device)._native, native, config, effects, approximations, turns, times, progress))


def _divided(names: str | None) -> tuple[str | None, str]:
    """Names of effects, or None for those of the scene; and names of approximations."""
    if names is None:
        return None, ",".join(_APPROXIMATIONS)
    given = [name.strip() for name in names.split(",") if name.strip()]
    approximations = [name for name in given if name in _APPROXIMATIONS]
    return ",".join(name for name in given if name not in _APPROXIMATIONS), ",".join(approximations) or "nothing"
