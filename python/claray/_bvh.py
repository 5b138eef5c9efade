"""The acceleration structure."""

from __future__ import annotations

import os
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import (NO_WORDS, builder_called, check_choice, finite, flag, floats, indices, local, number, origin_of, path_of,
                      places, words)
from ._device import AnyDevice, Device, device_of
from ._handle import Handle
from ._scene import Scene
from .errors import UsageError


class Bvh(Handle):
    """A bounding volume hierarchy over triangles, in device memory.

    vertices: (V, 3) numbers, in any unit; or a Scene, whose placed meshes become the geometries, in order.
    triangles: (T, 3) indices of vertices. A front face has its vertices counter-clockwise.
    geometries: (T,) the geometry of each triangle, for hits['geometry'] and masks; None: all 0.
    masks: (G,) one for each geometry; a ray sees it if their masks share a bit; None: all see all.
    device: a Device, "cpu", "gpu", an index of devices() or a part of a name; None: default_device().
    builder: "automatic" (high on GPUs, else balanced), "fast", "balanced", "high" or "binned": build time for the speed
        of queries.
    split_budget: builder "high": additional references from splitting large triangles, per triangle. Use 0 for geometry
    that will be refitted.
    layout: "automatic", "binary" or "wide".
    learns: whether queries may replace the tree by one of "high", once rays have been traced for ten times as long as its
        build takes: see docs/queries.md. None: if builder is "automatic".
    origin: of local coordinates, (3,), or "auto": the middle of the vertices. Vertices, and rays and points of all queries, are
        shifted by it in float64 before they are rounded to float32: for maps in metres, for instance. None: no shift. Not for a
        Scene.
    nan: "raise" an error for vertices that are not finite in float32, or "omit" their triangles. A Scene's are omitted.

    The arrays are copied to the device as float32. A warning tells if that rounds vertices by more than 1e-5 of their extent.
    Triangles of no area are left out: see statistics()['culled'].
    Raises UsageError, naming the argument, for wrong shapes and types, no triangles, indices out of range, and vertices
    that are not finite in float32 unless they are omitted; DeviceError if the device has too little memory.
    """

    __slots__ = ("_device", "_native", "_origin", "_queries")
    _instead_of_pickling = "build it in each process, or save() it to a file and load() that"

    def __init__(self, vertices: ArrayLike | Scene, triangles: ArrayLike | None = None, *, geometries: ArrayLike | None = None,
                 masks: ArrayLike | None = None, device: AnyDevice = None, builder: str = "automatic",
                 split_budget: float = 0.5, layout: str = "automatic", learns: bool | None = None,
                 nan: Literal["raise", "omit"] = "raise", origin: ArrayLike | Literal["auto"] | None = None) -> None:
        self._device, self._origin = device_of(device), None
        check_choice("layout", layout, ("automatic", "binary", "wide"))
        check_choice("nan", nan, ("raise", "omit"))
        options = (builder_called(builder), number("split_budget", split_budget), layout,
                   0 if learns is None else 1 if flag("learns", learns) else -1)
        if isinstance(vertices, Scene):
            if triangles is not None or geometries is not None or masks is not None:
                raise UsageError("triangles: a Scene has its own triangles, geometries and masks; leave them out")
            if origin is not None:
                raise UsageError("origin: the vertices of a Scene are float32 already; build the structure over arrays")
            if vertices.triangle_count == 0:
                raise UsageError("vertices: the scene has no triangles")
            self._native = _native.NativeBvh.build_of_scene(self._device._native, vertices._native, *options)
        else:
            if triangles is None:
                raise UsageError("triangles: missing; give (T, 3) indices of vertices")
            given = floats("vertices", vertices, 3)
            self._origin = origin_of(origin, given)
            points = places("vertices", given, nan, self._origin)
            faces = indices("triangles", triangles, 3, len(points), "vertices")
            if len(faces) == 0:
                raise UsageError("triangles: empty; a structure needs at least one triangle")
            numbers = words("geometries", geometries, len(faces))
            visible = NO_WORDS if masks is None else words("masks", masks, len(np.atleast_1d(masks)))
            if masks is not None and int(numbers.max(initial=0)) >= len(visible):
                raise UsageError(f"masks: has {len(visible)} rows, but geometries holds {int(numbers.max(initial=0))}")
            self._native = _native.NativeBvh.build(self._device._native, points, faces, numbers, visible, *options)
        self._queries: dict[Any, Any] = {}

    @classmethod
    def _of_mesh(cls, scene: Scene, mesh: int, device: Device, builder: str) -> Bvh:
        bvh = cls.__new__(cls)
        bvh._device, bvh._origin = device, None
        bvh._native = _native.NativeBvh.build_of_mesh(device._native, scene._native, mesh, builder_called(builder))
        bvh._queries = {}
        return bvh

    @classmethod
    def load(cls, path: str | os.PathLike[str], device: AnyDevice = None, *, origin: ArrayLike | None = None) -> Bvh:
        """Loads a structure that save() wrote, to a device as of Bvh. origin: that with which it was built. Raises InputError, naming the
        file, if it is missing or damaged."""
        bvh = cls.__new__(cls)
        bvh._device, bvh._origin = device_of(device), origin_of(origin, np.empty((0, 3)))
        bvh._native = _native.NativeBvh.load(bvh._device._native, path_of("path", path))
        bvh._queries = {}
        return bvh

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the structure and its triangles to a file, which appears only when it is complete."""
        self._native.save(path_of("path", path))

    def _local(self, name: str, points: ArrayLike) -> NDArray[Any]:
        return local(floats(name, points, 3), self._origin)

    def refit(self, vertices: ArrayLike) -> None:
        """Moves the vertices, (V, 3) as before, and keeps the tree: fast, but queries get slower with more motion."""
        self._native.move_vertices(finite("vertices", self._local("vertices", vertices)), False)

    def rebuild(self, vertices: ArrayLike) -> None:
        """Moves the vertices, (V, 3) as before, and builds the tree again."""
        self._native.move_vertices(finite("vertices", self._local("vertices", vertices)), True)

    def cost_growth(self) -> float:
        """The tree's cost relative to that at the last build; from about 1.4 on, rebuild() pays."""
        return self._native.cost_growth()

    def statistics(self) -> dict[str, Any]:
        """Counts of triangles, culled triangles and additional references, height, SAH cost, bytes on the device."""
        return self._native.statistics()

    @property
    def origin(self) -> tuple[float, float, float] | None:
        """Of the local coordinates; None: they are those of the world. A file of save() does not have it."""
        return None if self._origin is None else cast("tuple[float, float, float]", tuple(self._origin.tolist()))

    @property
    def is_closed(self) -> bool:
        """Whether the triangles close: every edge belongs to an even number of them. Edges are the same if the coordinates
        of their ends are. An open surface has no inside. Computed once, and after refit and rebuild again."""
        return self._native.is_closed()

    def is_valid(self) -> bool:
        """Checks every leaf, box and link of the tree on the device."""
        return self._native.is_valid()

    def hash(self) -> str:
        """32 hexadecimal digits that are equal on all devices that build the same tree."""
        return self._native.hash()

    @property
    def device(self) -> Device:
        return self._device

    @property
    def triangle_count(self) -> int:
        return self._native.triangle_count()

    @property
    def is_replaced(self) -> bool:
        """Whether queries trace a better tree than the one that was built: see `learns`."""
        return self._native.is_replaced()

    def __repr__(self) -> str:
        return f"<claray.Bvh of {self.triangle_count} triangles on {self._device.name}>"


def check_bvh(bvh: Any) -> None:
    """For queries that only triangles answer."""
    if not isinstance(bvh, Bvh):
        raise UsageError(f"bvh: is a {type(bvh).__name__}; use a claray.Bvh (other structures: closest_hit and any_hit)")
