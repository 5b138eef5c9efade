"""Queries: the closest hit of each ray, and whether a ray hits anything."""

from __future__ import annotations

from typing import Any, Iterable, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import HIT, INSTANCE_HIT, NO_FLOATS, RAY, as_array, check_choice, distances, floats, output, pointer, words
from ._bvh import Bvh
from ._device import Device, Event, native_events
from ._filter import NO_FILTER, Filter
from ._instances import InstancedBvh
from ._primitives import Primitives
from .errors import UsageError

Coherence = Literal["automatic", "coherent", "incoherent"]
Structure = Union[Bvh, InstancedBvh, Primitives]
_COHERENCE = {"automatic": 0, "coherent": 1, "incoherent": 2}


class Query:
    """A query that is made once, which loads its kernels, and run often.

    bvh: a Bvh, InstancedBvh or Primitives. kind: "closest" or "any".
    cull_back_faces: hit only triangles whose vertices appear counter-clockwise.
    closed: rays that only touch a surface hit it; see closest_hit.
    coherence: whether neighbouring rays have similar directions, as camera rays do; affects speed only.
    brute_force: test every triangle without the tree; the hits are the same.
    filter: a Filter of the hits of a Bvh; only those that it accepts count. Rays are then traced one by one.
    queue: a device made by bvh.device.with_new_queue(), for queries at the same time; None: the structure's own.

    Primitives have no faces: cull_back_faces, closed, filter, queue and masks are for triangles. Call it as closest_hit
    and any_hit, without the structure: query(origins, directions).
    """

    def __init__(self, bvh: Structure, kind: Literal["closest", "any"] = "closest", *, cull_back_faces: bool = False,
                 closed: bool = False, coherence: Coherence = "automatic", brute_force: bool = False,
                 filter: Filter | None = None, queue: Device | None = None) -> None:
        _check_structure(bvh)
        _refuse_for(bvh, {"cull_back_faces": cull_back_faces, "closed": closed, "filter": filter, "queue": queue})
        check_choice("kind", kind, ("closest", "any"))
        check_choice("coherence", coherence, tuple(_COHERENCE))
        self._bvh = bvh
        self._dtype = np.dtype(bool) if kind == "any" else INSTANCE_HIT if isinstance(bvh, InstancedBvh) else HIT
        native_queue = (queue or bvh.device)._native
        self._native = _native.NativeQuery.make(bvh._native, native_queue, kind == "any", bool(cull_back_faces),
                                                bool(closed), bool(brute_force), _COHERENCE[coherence], native_filter(filter))

    def __call__(self, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
                 tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, times: ArrayLike | None = None,
                 nan: Literal["raise", "miss"] = "raise", out: NDArray[Any] | None = None) -> NDArray[Any]:
        """Traces rays of the host and waits for the results. See closest_hit."""
        check_choice("nan", nan, ("raise", "miss"))
        if directions is None:
            return self._trace_packed(origins, masks, times, nan, out)
        starts, towards = _pair(origins, directions)
        count = len(towards)
        low, high = _ends(tmin, tmax, count)
        per_ray = self._per_ray(masks, times, count)
        results = output("out", out, count, self._dtype)
        if count == 0:
            return results
        _refuse_bad(self._native.run_columns(starts, towards, low, high, *per_ray, _bytes(results)), starts, nan)
        return results

    def _per_ray(self, masks: ArrayLike | None, times: ArrayLike | None, count: int) -> tuple[NDArray[Any], NDArray[Any]]:
        _refuse_for(self._bvh, {"masks": masks, "times": times})
        if times is None:
            return words("masks", masks, count), NO_FLOATS
        at = distances("times", times, count)
        if count and not (0 <= at.min() and at.max() <= 1):
            raise UsageError("times: holds numbers outside 0 to 1")
        return words("masks", masks, count), np.ascontiguousarray(at, np.float32)

    def _trace_packed(self, rays: ArrayLike, masks: ArrayLike | None, times: ArrayLike | None, nan: str,
                      out: NDArray[Any] | None) -> NDArray[Any]:
        check = nan == "raise" and not getattr(rays, "_checked", False)
        packed = _packed(rays)
        count = len(packed)
        per_ray = self._per_ray(masks, times, count)
        results = output("out", out, count, self._dtype)
        if count == 0:
            return results
        _refuse_bad_packed(self._native.run_packed(packed, *per_ray, _bytes(results), check))
        return results

    def run(self, rays: Any, results: Any, count: int, wait_for: Iterable[Any] = ()) -> Event:
        """Enqueues the query over buffers of the device, and returns the event of its end. Asynchronous.

        rays: a pyopencl.Buffer (or its int_ptr) of `count` rays of dtype RAY, in the context of the device.
        results: a buffer for `count` elements of dtype HIT (of an InstancedBvh: INSTANCE_HIT), or of one byte each for
        kind "any".
        wait_for: events of claray or pyopencl. Give `coherence` to the query, so that nothing else is waited for.
        Raises UsageError, before anything is enqueued, for buffers that are too small or of another context.
        """
        events = native_events(wait_for)
        if not isinstance(count, (int, np.integer)) or count < 0:
            raise UsageError(f"count: is {count!r}; use a number of rays")
        native = self._native.run_buffers(pointer("rays", rays), pointer("results", results), int(count), events)
        return Event._of(native, (rays, results))


def _check_structure(bvh: Any) -> None:
    if not isinstance(bvh, (Bvh, InstancedBvh, Primitives)):
        raise UsageError(f"bvh: is a {type(bvh).__name__}; use a claray.Bvh, InstancedBvh or Primitives")


def _refuse_for(bvh: Structure, options: dict[str, Any]) -> None:
    """Refuses options that queries of this structure do not have."""
    for name, value in options.items():
        if value is None or value is False:
            continue
        if name == "times" and not (isinstance(bvh, InstancedBvh) and bvh.moves):
            raise UsageError("times: the structure does not move; give `ends` to a claray.InstancedBvh")
        if isinstance(bvh, Primitives) and name != "times" or isinstance(bvh, InstancedBvh) and name == "filter":
            raise UsageError(f"{name}: not for queries of {type(bvh).__name__}; use a claray.Bvh")


def native_filter(filter: Filter | None) -> Any:
    if filter is not None and not isinstance(filter, Filter):
        raise UsageError(f"filter: is a {type(filter).__name__}; use a claray.Filter")
    return NO_FILTER if filter is None else filter._native


def _bytes(results: NDArray[Any]) -> NDArray[np.uint8]:
    return results.view(np.uint8).reshape(len(results), results.dtype.itemsize)


def _ends(tmin: ArrayLike, tmax: ArrayLike, count: int) -> tuple[NDArray[Any], NDArray[Any]]:
    low, high = distances("tmin", tmin, count), distances("tmax", tmax, count)
    if count and low.min() < 0:
        raise UsageError("tmin: holds a negative number")
    return low, high


def _refuse_bad(row: int, starts: NDArray[Any], nan: str) -> None:
    if row < 0 or nan != "raise":
        return
    with np.errstate(over="ignore"):
        name = "directions" if np.isfinite(starts[row].astype(np.float32)).all() else "origins"
    raise UsageError(f"{name}: row {row} is not finite in float32; remove it, or pass nan='miss'")


def _refuse_bad_packed(row: int) -> None:
    if row >= 0:
        raise UsageError(f"rays: the origin or direction of row {row} is not finite; remove it, or pass nan='miss'")


def _pair(origins: ArrayLike, directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    """Origins and directions of shape (N, 3); one of them may be a single vector for all rays."""
    starts, towards = as_array("origins", origins), as_array("directions", directions)
    one_start, one_direction = starts.ndim == 1, towards.ndim == 1
    starts = floats("origins", starts[None] if one_start else starts, 3)
    towards = floats("directions", towards[None] if one_direction else towards, 3)
    if one_start:
        starts = np.broadcast_to(starts, towards.shape)
    elif one_direction:
        towards = np.broadcast_to(towards, starts.shape)
    if len(starts) != len(towards):
        raise UsageError(f"directions: has {len(towards)} rows, but origins has {len(starts)}")
    return starts, towards


def _packed(rays: ArrayLike) -> NDArray[np.float32]:
    array = as_array("rays", rays)
    if array.dtype == RAY and array.ndim == 1:
        array = np.ascontiguousarray(array).view(np.float32).reshape(len(array), 8)
    if array.dtype != np.float32 or array.ndim != 2 or array.shape[1] != 8:
        raise UsageError(f"rays: has dtype {array.dtype} and shape {array.shape}; give origins and directions, or an array "
                         "of dtype claray.RAY, or float32 of shape (N, 8)")
    return np.ascontiguousarray(array)


class Rays(np.ndarray):
    """Rays of dtype RAY that rays() has checked, which is why the array is read-only. A copy is an ordinary array."""

    _checked = False

    def __array_finalize__(self, source: Any) -> None:
        self._checked = isinstance(source, Rays) and source._checked and self.base is not None


def rays(origins: ArrayLike, directions: ArrayLike, tmin: ArrayLike = 0.0, tmax: ArrayLike = np.inf, *,
         nan: Literal["raise", "miss"] = "raise") -> Rays:
    """A read-only array of dtype RAY, which queries read in place: for rays that are traced several times.

    The arguments are those of closest_hit. They are checked here, once.
    """
    check_choice("nan", nan, ("raise", "miss"))
    starts, towards = _pair(origins, directions)
    count = len(towards)
    low, high = _ends(tmin, tmax, count)
    packed = np.empty(count, RAY)
    if count:
        _refuse_bad(_native.pack_rays(starts, towards, low, high, packed.view(np.float32).reshape(count, 8)), starts, nan)
    packed.flags.writeable = False
    result = packed.view(Rays)
    result._checked = True
    return result


def packed_rays(origins: ArrayLike, directions: ArrayLike | None, tmin: ArrayLike, tmax: ArrayLike, nan: str) -> NDArray[np.float32]:
    """Rays as float32 of shape (N, 8), checked."""
    if directions is not None:
        return _packed(rays(origins, directions, tmin, tmax, nan=nan))  # type: ignore[arg-type]
    check_choice("nan", nan, ("raise", "miss"))
    packed = _packed(origins)
    if nan == "raise" and not getattr(origins, "_checked", False):
        bad = np.flatnonzero(~np.isfinite(packed[:, [0, 1, 2, 4, 5, 6]]).all(axis=1))
        _refuse_bad_packed(int(bad[0]) if len(bad) else -1)
    return packed


def _query_of(bvh: Structure, kind: Literal["closest", "any"], cull_back_faces: bool, closed: bool, coherence: Coherence,
              filter: Filter | None) -> Query:
    _check_structure(bvh)
    if filter is not None:  # the kernels stay loaded, and the query costs little
        return Query(bvh, kind, cull_back_faces=cull_back_faces, closed=closed, coherence=coherence, filter=filter)
    key = (kind, bool(cull_back_faces), bool(closed), coherence)
    if key not in bvh._queries:
        bvh._queries[key] = Query(bvh, kind, cull_back_faces=cull_back_faces, closed=closed, coherence=coherence)
    return bvh._queries[key]


def closest_hit(bvh: Structure, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
                tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, times: ArrayLike | None = None,
                cull_back_faces: bool = False, closed: bool = False, filter: Filter | None = None,
                coherence: Coherence = "automatic", nan: Literal["raise", "miss"] = "raise",
                out: NDArray[Any] | None = None) -> NDArray[Any]:
    """Finds the closest hit of every ray.

    bvh: a Bvh, InstancedBvh or Primitives.
    origins: (N, 3) numbers, or (3,) for all rays; or rays in one array of dtype RAY, which is read in place. Any
    strides; float64 is rounded to float32. directions: (N, 3) or (3,); they need not have unit length.
    tmin, tmax: hits have tmin < t <= tmax, in units of the direction's length; one number, or (N,).
    masks: (N,) a ray sees geometries whose mask shares a bit with its own.
    times: (N,) or one number, 0 to 1: when the ray passes, for an InstancedBvh that moves.
    cull_back_faces: hit only triangles whose vertices appear counter-clockwise.
    closed: rays that only touch a surface, at its border or at an edge seen from the side, hit it.
    filter: a Filter of hits; the ray goes on behind those that it does not accept. For a Bvh.
    coherence: whether neighbouring rays have similar directions; affects speed only.
    nan: "raise": a ray that is not finite is an error; "miss": it hits nothing.
    out: an array of N elements of dtype HIT to be filled, as of an earlier call.

    Returns N hits of dtype HIT: hits['t'] (distance; tmax on a miss), 'u', 'v' (weights of the triangle's second and
    third vertex), 'primitive' (index of the triangle; MISS on a miss) and 'geometry'. A ray through an edge or a vertex
    hits exactly one of the triangles that share it (closed: any of them). Of an InstancedBvh the hits have dtype
    INSTANCE_HIT: hits['instance'], too. Of Primitives, 'u' and 'v' are what the kind sets, and 'geometry' is 0.

    Releases the GIL. Raises UsageError, naming the argument, for wrong shapes, types and values.
    """
    query = _query_of(bvh, "closest", cull_back_faces, closed, coherence, filter)
    return query(origins, directions, tmin=tmin, tmax=tmax, masks=masks, times=times, nan=nan, out=out)


def any_hit(bvh: Structure, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
            tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, times: ArrayLike | None = None,
            cull_back_faces: bool = False, closed: bool = False, filter: Filter | None = None,
            coherence: Coherence = "automatic", nan: Literal["raise", "miss"] = "raise",
            out: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
    """Returns for every ray whether it hits anything, as N bool. Arguments and errors are those of closest_hit."""
    query = _query_of(bvh, "any", cull_back_faces, closed, coherence, filter)
    return query(origins, directions, tmin=tmin, tmax=tmax, masks=masks, times=times, nan=nan, out=out)


def unoccluded(bvh: Structure, points: ArrayLike, targets: ArrayLike, *, offset: float = 1e-4) -> NDArray[np.bool_]:
    """Returns for every pair whether the segment between them is free.

    points, targets: (N, 3), or (3,) for all. offset: the share of the segment that is left out at both ends, so that the
    surfaces on which the points lie do not count.
    """
    starts, ends = _pair(points, targets)
    return ~any_hit(bvh, starts, ends.astype(np.float64) - starts, tmin=offset, tmax=1 - offset)
