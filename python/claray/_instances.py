"""Instances: placements of structures, which share their memory."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import builder_called, members, words
from ._bvh import Bvh
from ._device import AnyDevice, Device, device_of
from ._handle import Handle
from ._scene import Scene
from ._transforms import rows_of
from .errors import UsageError


def _structures(bvhs: Any) -> list[Bvh]:
    structures = [bvhs] if isinstance(bvhs, Bvh) else members("bvhs", bvhs, "claray.Bvh")
    if not structures or not all(isinstance(bvh, Bvh) for bvh in structures):
        raise UsageError("bvhs: use a claray.Bvh, or a sequence of at least one")
    if any(bvh.origin is not None for bvh in structures):
        raise UsageError("bvhs: a structure with an origin cannot be placed; build it without")
    return structures


class InstancedBvh(Handle):
    """A structure of two levels: instances place whole structures. Queries take it as a Bvh; see closest_hit.

    bvhs: a Bvh or a sequence of them, of one device and layout; they are shared or copied on the device.
    transforms: (N, 4, 4) or (N, 3, 4) matrices from the coordinates of a structure to those of the world: the last column
    is the translation. bottoms: (N,) the structure of each instance, as an index of bvhs; None: all are instances of the
    first. masks: (N,) a ray sees an instance if their masks share a bit; None: all see all. ends: as transforms, at time
    1: instances then move, and rays have times; matrices in between are interpolated linearly.
    builder: of the upper level.

    Instances whose matrix cannot be inverted are left out: see statistics()['culled']. Raises UsageError, naming the
    argument, for wrong shapes, types and values.
    """

    __slots__ = ("_builder", "_count", "_device", "_given", "_native", "_only", "_queries")
    _instead_of_pickling = "build it in each process"

    def __init__(self, bvhs: Bvh | Sequence[Bvh], transforms: ArrayLike, *, bottoms: ArrayLike | None = None,
                 masks: ArrayLike | None = None, ends: ArrayLike | None = None, builder: str = "fast") -> None:
        structures = _structures(bvhs)
        self._device, self._builder = structures[0].device, builder_called(builder)
        self._native = _native.NativeInstancedBvh.build(self._device._native, *self._placed(structures, transforms, ends, bottoms, masks))
        self._note(structures, bottoms, masks)
        self._queries: dict[Any, Any] = {}

    def _placed(self, structures: list[Bvh], transforms: ArrayLike, ends: ArrayLike | None, bottoms: ArrayLike | None,
                masks: ArrayLike | None) -> tuple[Any, ...]:
        """What the native functions take, checked."""
        begin = rows_of("transforms", transforms)
        if len(begin) == 0:
            raise UsageError("transforms: empty; give at least one instance")
        which = words("bottoms", bottoms, len(begin))
        if int(which.max(initial=0)) >= len(structures):
            raise UsageError(f"bottoms: holds {int(which.max())}, but bvhs has {len(structures)} structures")
        end = begin[:0] if ends is None else self._ends(ends, len(begin))
        return [bvh._native for bvh in structures], begin, end, which, words("masks", masks, len(begin)), self._builder

    def _note(self, structures: list[Bvh], bottoms: ArrayLike | None, masks: ArrayLike | None) -> None:
        """Several structures are copies on the device, and are not kept."""
        self._only = structures[0] if len(structures) == 1 else None
        self._count, self._given = self._native.count(), {"bottoms": bottoms is not None, "masks": masks is not None}

    @classmethod
    def of_scene(cls, scene: Scene, *, device: AnyDevice = None, builder: str = "automatic") -> InstancedBvh:
        """The meshes of a scene, each built once, where the scene places them.

        hits['instance'] is the number of the instance, hits['primitive'] the triangle of its mesh; scene.instances tells
        which mesh that is. device, builder: of the meshes' structures. If instances move (scene.instances has 'ends'), rays have
        times. Raises UsageError for a scene without triangles.
        """
        if not isinstance(scene, Scene) or scene.triangle_count == 0:
            raise UsageError(f"scene: is {scene!r}; use a claray.Scene with triangles")
        placed = scene.instances
        on = device_of(device)
        used, which = np.unique(placed["meshes"], return_inverse=True)
        bvhs = [Bvh._of_mesh(scene, int(mesh), on, builder) for mesh in used]
        return cls(bvhs, placed["transforms"], bottoms=which, ends=placed["ends"])

    @staticmethod
    def _ends(ends: ArrayLike, count: int) -> NDArray[np.float32]:
        rows = rows_of("ends", ends)
        if len(rows) != count:
            raise UsageError(f"ends: has {len(rows)} matrices, but there are {count} instances")
        return rows

    def _move(self, transforms: ArrayLike, ends: ArrayLike | None, rebuild: bool) -> None:
        begin = rows_of("transforms", transforms)
        if len(begin) != self._count:
            raise UsageError(f"transforms: has {len(begin)} matrices, but there are {self._count} instances")
        if (ends is not None) != self.moves:
            raise UsageError("ends: must be given if, and only if, it was given when the structure was built")
        self._native.move(begin, begin[:0] if ends is None else self._ends(ends, self._count), rebuild)

    def refit(self, transforms: ArrayLike, ends: ArrayLike | None = None) -> None:
        """Moves the instances, (N, 4, 4) or (N, 3, 4) as before, and keeps the tree of the upper level."""
        self._move(transforms, ends, False)

    def rebuild(self, transforms: ArrayLike, ends: ArrayLike | None = None, *, bvhs: Bvh | Sequence[Bvh] | None = None,
                bottoms: ArrayLike | None = None, masks: ArrayLike | None = None) -> None:
        """Moves the instances, and builds the upper level again. Takes over changes of a single structure, too.

        There may be more instances, or fewer. bottoms, masks: then of the new ones, if they were given before. bvhs: other
        structures; needed for another number of instances of several structures, which are copied again. Queries made before trace
        the new instances.
        """
        given = rows_of("transforms", transforms)
        if len(given) == self._count and bvhs is None and bottoms is None and masks is None:
            self._move(given, ends, True)
            return
        if (ends is not None) != self.moves:
            raise UsageError("ends: must be given if, and only if, it was given when the structure was built")
        for name, value in (("bottoms", bottoms), ("masks", masks)):
            if value is None and self._given[name]:
                raise UsageError(f"{name}: was given before; give it for the new instances, too")
        if bvhs is None and self._only is None:
            raise UsageError("bvhs: must be given for other instances of several structures")
        structures = [self._only] if bvhs is None and self._only is not None else _structures(bvhs)
        self._native.replace(*self._placed(structures, given, ends, bottoms, masks))
        self._note(structures, bottoms, masks)

    def statistics(self) -> dict[str, Any]:
        """Counts of instances and culled instances, height and SAH cost of the upper level, bytes of both levels."""
        return self._native.statistics()

    def is_valid(self) -> bool:
        """Checks every leaf, box and link of the upper level on the device."""
        return self._native.is_valid()

    @property
    def moves(self) -> bool:
        """Whether the instances move between time 0 and 1."""
        return self._native.moves()

    @property
    def device(self) -> Device:
        return self._device

    @property
    def instance_count(self) -> int:
        return self._count

    def __repr__(self) -> str:
        return f"<claray.InstancedBvh of {self._count} instances on {self._device.name}>"
