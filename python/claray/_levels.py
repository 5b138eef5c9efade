"""Instances of several levels, as instances of one."""

# No postponed annotations: those of a NamedTuple could not be evaluated by what reads them, such as pdoc.
from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import MISS, words
from ._lists import Lists
from ._transforms import rows_of
from .errors import UsageError


class Instances(NamedTuple):
    """Placements, for flatten.

    transforms: (N, 4, 4) or (N, 3, 4) matrices.
    bottoms: (N,) what each places; None: all place 0.
    masks: (N,) bits; None: all bits.
    """

    transforms: ArrayLike
    bottoms: ArrayLike | None = None
    masks: ArrayLike | None = None


class FlatInstances(NamedTuple):
    """Instances of one level: InstancedBvh(bvhs, flat.transforms, bottoms=flat.bottoms, masks=flat.masks).

    transforms: (N, 3, 4).
    bottoms, masks: (N,).
    steps: steps[i] tells how instance i is reached: by which instance of the roots, by which of its group, and so on.
    """

    transforms: NDArray[np.float32]
    bottoms: NDArray[np.uint32]
    masks: NDArray[np.uint32]
    steps: Lists


def flatten(roots: Instances, groups: Sequence[Instances], structures: int = 1) -> FlatInstances:
    """Turns instances of several levels into instances of one.

    A number in `bottoms` below `structures` is a structure; `structures` + g places all instances of groups[g], which may
    place groups themselves. Transforms are multiplied in float64 and rounded once. The mask of a flat instance has the
    bits that all masks on its way share. The order is that of a depth-first walk. The structures are shared; every flat
    instance takes about 300 bytes on the device.

    Raises UsageError for a group that contains itself or does not exist, and, naming the argument, for wrong shapes,
    types and values.
    """
    if not isinstance(structures, (int, np.integer)) or not 0 < structures < MISS:
        raise UsageError(f"structures: is {structures!r}; use the number of structures")
    if not isinstance(groups, (list, tuple)):
        raise UsageError(f"groups: is a {type(groups).__name__}; use a list of claray.Instances")
    levels = [_level(f"groups[{i}]", group) for i, group in enumerate(groups)]
    transforms, bottoms, masks, offsets, steps = _native.flatten(_level("roots", roots), levels, int(structures))
    return FlatInstances(transforms, bottoms, masks, Lists(offsets, steps))


def _level(name: str, given: Instances) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    if not isinstance(given, Instances):
        raise UsageError(f"{name}: is a {type(given).__name__}; use claray.Instances")
    rows = rows_of(f"{name}.transforms", given.transforms)
    return rows, words(f"{name}.bottoms", given.bottoms, len(rows)), words(f"{name}.masks", given.masks, len(rows))
