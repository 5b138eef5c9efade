"""Geometry that is not triangles: spheres, discs, cylinders, curves, and shapes whose text the caller gives."""

from __future__ import annotations

from typing import Any, Callable, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import as_array, builder_called, check_choice, finite, finite_vector, flag, floats, indices, places
from ._device import AnyDevice, Device, device_of
from ._handle import Handle
from .errors import UsageError


def _radii(name: str, value: Any, count: int) -> NDArray[np.float32]:
    radii = finite_vector(name, value, count)
    if count and radii.min() < 0:
        raise UsageError(f"{name}: row {int(radii.argmin())} is {radii.min()}; use radii of 0 or more")
    return radii


def _places(name: str, value: Any, count: int | None = None) -> NDArray[np.float32]:
    rows = places(name, value)
    if len(rows) == 0:
        raise UsageError(f"{name}: empty; a structure needs at least one primitive")
    if count is not None and len(rows) != count:
        raise UsageError(f"{name}: has {len(rows)} rows; it must have {count}")
    return rows


def sphere_rows(centers: ArrayLike, radii: ArrayLike) -> NDArray[np.float32]:
    """(N, 4): centre and radius."""
    rows = _places("centers", centers)
    return np.column_stack([rows, _radii("radii", radii, len(rows))])


def disc_rows(centers: ArrayLike, normals: ArrayLike, radii: ArrayLike, holes: ArrayLike = 0.0) -> NDArray[np.float32]:
    """(N, 8): centre and radius, normal and radius of the hole."""
    rows = _places("centers", centers)
    count = len(rows)
    return np.column_stack([rows, _radii("radii", radii, count), _places("normals", normals, count), _radii("holes", holes, count)])


def cylinder_rows(starts: ArrayLike, ends: ArrayLike, radii: ArrayLike, capped: bool) -> NDArray[np.float32]:
    """(N, 8): start and radius, end and whether discs close the ends."""
    rows = _places("starts", starts)
    count = len(rows)
    return np.column_stack([rows, _radii("radii", radii, count), _places("ends", ends, count), np.full(count, flag("capped", capped), np.float32)])


def curve_arrays(points: ArrayLike, radii: ArrayLike, segments: ArrayLike | None, basis: str) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """(P, 4): place and radius of each control point; and the first control point of each segment."""
    check_choice("basis", basis, ("bspline", "bezier"))
    controls = as_array("points", points)
    if controls.ndim < 2:
        raise UsageError(f"points: has shape {controls.shape}; it must be (P, 3) or (C, K, 3)")
    if segments is None:
        first = _segments_of_curves(controls, 1 if basis == "bspline" else 3)
    else:
        rows = as_array("segments", segments)
        first = indices("segments", rows[:, None] if rows.ndim == 1 else rows, 1, max(0, len(controls) - 3),
                        f"points, of which a segment needs four in a row, {len(controls)} rows and")[:, 0]
    if len(first) == 0:
        raise UsageError("segments: empty; at least one segment is needed")
    return _control_points(points, radii), first


class Primitives(Handle):
    """A structure over primitives of one kind. Queries take it as a Bvh: hits['primitive'] is the index of the primitive.

    source: OpenCL C that defines the box and the hits of a primitive:

        static inline PrimitiveBox bounds_of(global const float* data, uint primitive);
        static inline bool intersect(global const float* data, uint primitive, float3 origin, float3 direction, float tmin,
                                     Hit* hit);

    docs/queries.md has an example; kernels/primitives/primitive.clh describes both and has helpers.
    data: (N, K) numbers, K for each primitive: `data` of the functions begins with those of primitive 0. Not finite
    numbers are errors. name: for messages of the compiler. device, builder: as of Bvh.

    Primitives whose box is not finite are left out: see `culled`. A text that does not compile raises DeviceError. The
    path tracer renders those of a Scene (Scene.add_spheres and others).
    """

    __slots__ = ("_device", "_native", "_pack", "_queries")
    _instead_of_pickling = "build it in each process"

    def __init__(self, source: str, data: ArrayLike, *, name: str = "primitives", device: AnyDevice = None,
                 builder: str = "balanced") -> None:
        if not isinstance(source, str) or not source.strip():
            raise UsageError("source: must be a text that defines bounds_of and intersect")
        numbers = self._rows(data)
        on = device_of(device)
        self._hold(on, _native.NativePrimitives.build_text(on._native, str(name), source, numbers.ravel(), len(numbers), builder_called(builder)),
                   self._rows)

    @staticmethod
    def _rows(data: ArrayLike) -> NDArray[np.float32]:
        array = as_array("data", data)
        if array.ndim != 2 or array.shape[0] == 0 or array.shape[1] == 0:
            raise UsageError(f"data: has shape {array.shape}; it must be (N, K) with N and K of at least 1")
        return finite("data", floats("data", array, array.shape[1]))

    def _hold(self, device: Device, native: Any, pack: Callable[..., NDArray[np.float32]]) -> None:
        self._device, self._native, self._pack = device, native, pack
        self._queries: dict[Any, Any] = {}

    @classmethod
    def _built_in(cls, kind: str, device: AnyDevice, builder: str, pack: Callable[..., NDArray[np.float32]],
                  *arrays: ArrayLike) -> Primitives:
        made = cls.__new__(cls)
        numbers = pack(*arrays)
        on = device_of(device)
        made._hold(on, _native.NativePrimitives.build(on._native, kind, numbers.ravel(), len(numbers), builder_called(builder)), pack)
        return made

    @classmethod
    def spheres(cls, centers: ArrayLike, radii: ArrayLike, *, device: AnyDevice = None, builder: str = "balanced") -> Primitives:
        """Spheres. centers: (N, 3). radii: (N,), or one number. Hits are solved in float64."""

        return cls._built_in("spheres", device, builder, sphere_rows, centers, radii)

    @classmethod
    def discs(cls, centers: ArrayLike, normals: ArrayLike, radii: ArrayLike, holes: ArrayLike = 0.0, *, device: AnyDevice = None,
              builder: str = "balanced") -> Primitives:
        """Discs. centers, normals: (N, 3), normals of any length. radii, holes: (N,), or one number: outer and inner
        radius. hits['u'] is the distance from the centre. A ray in the disc's plane misses it."""

        return cls._built_in("discs", device, builder, disc_rows, centers, normals, radii, holes)

    @classmethod
    def cylinders(cls, starts: ArrayLike, ends: ArrayLike, radii: ArrayLike, *, capped: bool = True, device: AnyDevice = None,
                  builder: str = "balanced") -> Primitives:
        """Cylinders. starts, ends: (N, 3) of their axes. radii: (N,), or one number. capped: whether discs close their
        ends. hits['u'] is the place along the axis, 0 to 1."""

        def pack(starts: ArrayLike, ends: ArrayLike, radii: ArrayLike) -> NDArray[np.float32]:
            return cylinder_rows(starts, ends, radii, capped)

        return cls._built_in("cylinders", device, builder, pack, starts, ends, radii)

    @classmethod
    def curves(cls, points: ArrayLike, radii: ArrayLike, segments: ArrayLike | None = None, *,
               basis: Literal["bspline", "bezier"] = "bspline", shape: Literal["round", "flat"] = "round",
               device: AnyDevice = None, builder: str = "binned") -> Primitives:
        """Cubic curves: hair, grass, wires. The primitives are their segments, of four control points each.

        points: (P, 3) control points, and segments: (S,) the index of the first control point of each segment; or, without
        segments, points: (C, K, 3), C curves of K control points each. Segments of a B-spline then begin at each control
        point, those of a Bezier curve at each third. radii: at the control points, (P,) or (C, K); or one number.
        shape: "round" (the hull of spheres along the curve, seen from outside only) or "flat" (a ribbon that faces every
        ray; hits['v'] is the place across it, -1 to 1). hits['u'] is the place along the segment, 0 to 1.
        """
        check_choice("shape", shape, ("round", "flat"))
        controls, first = curve_arrays(points, radii, segments, basis)

        def pack(points: ArrayLike, radii: ArrayLike) -> NDArray[np.float32]:
            moved = _control_points(points, radii)
            if len(moved) != len(controls):
                raise UsageError(f"points: has {len(moved)} rows, and the curves have {len(controls)}")
            data: Any = _native.curve_data(moved, first, basis == "bezier")
            return cast("NDArray[np.float32]", data)

        return cls._built_in(shape, device, builder, pack, points, radii)

    def _move(self, arrays: tuple[ArrayLike, ...], rebuild: bool) -> None:
        numbers, room = self._pack(*arrays), self._native.floats()
        if numbers.size != room:
            raise UsageError(f"arrays: hold {numbers.size} numbers, and the structure has {room}")
        self._native.move(numbers.ravel(), rebuild)

    def refit(self, *arrays: ArrayLike) -> None:
        """Changes the primitives, by the arrays with which they were made, and keeps the tree: fast, but queries get
        slower with more motion."""
        self._move(arrays, False)

    def rebuild(self, *arrays: ArrayLike) -> None:
        """Changes the primitives, by the arrays with which they were made, and builds the tree again."""
        self._move(arrays, True)

    @property
    def count(self) -> int:
        return int(self._native.count())

    @property
    def culled(self) -> int:
        """The number of primitives that were left out because their box is not finite."""
        return int(self._native.culled())

    @property
    def device(self) -> Device:
        return self._device

    def __repr__(self) -> str:
        return f"<claray.Primitives: {self.count} on {self._device.name}>"


def _segments_of_curves(points: NDArray[Any], step: int) -> NDArray[np.uint32]:
    """The first control points of the segments of C curves with K control points each."""
    if points.ndim != 3 or points.shape[2] != 3 or points.shape[1] < 4 or (points.shape[1] - 4) % step:
        needed = "4, 7, 10, ..." if step == 3 else "at least 4"
        raise UsageError(f"points: has shape {points.shape}; without segments it must be (C, K, 3), K {needed}")
    curves, controls = map(int, points.shape[:2])
    first: NDArray[Any] = np.arange(curves)[:, None] * controls + np.arange(0, controls - 3, step)
    return first.ravel().astype(np.uint32)


def _control_points(points: ArrayLike, radii: ArrayLike) -> NDArray[np.float32]:
    """(P, 4): place and radius."""
    controls = as_array("points", points)
    if controls.ndim < 2:
        raise UsageError(f"points: has shape {controls.shape}; it must be (P, 3) or (C, K, 3)")
    controls = _places("points", controls.reshape(-1, 3) if controls.ndim == 3 else controls)
    widths = as_array("radii", radii)
    return np.column_stack([controls, _radii("radii", widths if widths.ndim == 0 else widths.ravel(), len(controls))])
