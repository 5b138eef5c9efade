"""Queries: the closest hit of each ray, and whether a ray hits anything."""

from __future__ import annotations

from typing import Any, Iterable, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import HIT, NO_WORDS, RAY, as_array, distances, floats, output, pointer, words
from ._bvh import Bvh
from ._device import Device, Event, native_events
from .errors import UsageError

Coherence = Literal["automatic", "coherent", "incoherent"]
_COHERENCE = {"automatic": 0, "coherent": 1, "incoherent": 2}


class Query:
    """A query that is made once, which loads its kernels, and run often.

    bvh: the structure. kind: "closest" or "any".
    cull_back_faces: hit only triangles whose vertices appear counter-clockwise.
    closed: rays that only touch a surface hit it; see closest_hit.
    coherence: whether neighbouring rays have similar directions, as camera rays do; affects speed only.
    brute_force: test every triangle without the tree; the hits are the same.
    queue: a device made by bvh.device.with_new_queue(), for queries at the same time; None: the structure's own.

    Call it as closest_hit and any_hit, without the structure: query(origins, directions).
    """

    def __init__(self, bvh: Bvh, kind: Literal["closest", "any"] = "closest", *, cull_back_faces: bool = False,
                 closed: bool = False, coherence: Coherence = "automatic", brute_force: bool = False, queue: Device | None = None) -> None:
        if not isinstance(bvh, Bvh):
            raise UsageError(f"bvh: is a {type(bvh).__name__}; use a claray.Bvh")
        _check_choice("kind", kind, ("closest", "any"))
        _check_choice("coherence", coherence, tuple(_COHERENCE))
        self._dtype = HIT if kind == "closest" else np.dtype(bool)
        native_queue = (queue or bvh.device)._native
        self._native = _native.NativeQuery.make(bvh._native, native_queue, kind == "any", bool(cull_back_faces),
                                                bool(closed), bool(brute_force), _COHERENCE[coherence])

    def __call__(self, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
                 tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, nan: Literal["raise", "miss"] = "raise",
                 out: NDArray[Any] | None = None) -> NDArray[Any]:
        """Traces rays of the host and waits for the results. See closest_hit."""
        _check_choice("nan", nan, ("raise", "miss"))
        if directions is None:
            return self._trace_packed(origins, masks, nan, out)
        starts, towards = _pair(origins, directions)
        count = len(towards)
        low, high = _ends(tmin, tmax, count)
        visible = words("masks", masks, count)
        results = output("out", out, count, self._dtype)
        if count == 0:
            return results
        _refuse_bad(self._native.run_columns(starts, towards, low, high, visible, _bytes(results)), starts, nan)
        return results

    def _trace_packed(self, rays: ArrayLike, masks: ArrayLike | None, nan: str, out: NDArray[Any] | None) -> NDArray[Any]:
        check = nan == "raise" and not getattr(rays, "_checked", False)
        packed = _packed(rays)
        count = len(packed)
        visible = words("masks", masks, count)
        results = output("out", out, count, self._dtype)
        if count == 0:
            return results
        bad = self._native.run_packed(packed, visible, _bytes(results), check)
        if bad >= 0:
            raise UsageError(f"rays: the origin or direction of row {bad} is not finite; remove it, or pass nan='miss'")
        return results

    def run(self, rays: Any, results: Any, count: int, wait_for: Iterable[Any] = ()) -> Event:
        """Enqueues the query over buffers of the device, and returns the event of its end. Asynchronous.

        rays: a pyopencl.Buffer (or its int_ptr) of `count` rays of dtype RAY, in the context of the device.
        results: a buffer for `count` elements of dtype HIT, or of one byte each for kind "any".
        wait_for: events of claray or pyopencl. Give `coherence` to the query, so that nothing else is waited for.
        Raises UsageError, before anything is enqueued, for buffers that are too small or of another context.
        """
        events = native_events(wait_for)
        if not isinstance(count, (int, np.integer)) or count < 0:
            raise UsageError(f"count: is {count!r}; use a number of rays")
        native = self._native.run_buffers(pointer("rays", rays), pointer("results", results), int(count), events)
        return Event._of(native, (rays, results))


def _bytes(results: NDArray[Any]) -> NDArray[np.uint8]:
    return results.view(np.uint8).reshape(len(results), results.dtype.itemsize)


def _check_choice(name: str, value: Any, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise UsageError(f"{name}: unknown name {value!r}; use one of {', '.join(choices)}")


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
    _check_choice("nan", nan, ("raise", "miss"))
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


def _query_of(bvh: Bvh, kind: Literal["closest", "any"], cull_back_faces: bool, closed: bool, coherence: Coherence) -> Query:
    if not isinstance(bvh, Bvh):
        raise UsageError(f"bvh: is a {type(bvh).__name__}; use a claray.Bvh")
    key = (kind, bool(cull_back_faces), bool(closed), coherence)
    if key not in bvh._queries:
        bvh._queries[key] = Query(bvh, kind, cull_back_faces=cull_back_faces, closed=closed, coherence=coherence)
    return bvh._queries[key]


def closest_hit(bvh: Bvh, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
                tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, cull_back_faces: bool = False, closed: bool = False,
                coherence: Coherence = "automatic", nan: Literal["raise", "miss"] = "raise",
                out: NDArray[Any] | None = None) -> NDArray[Any]:
    """Finds the closest hit of every ray.

    origins: (N, 3) numbers, or (3,) for all rays; or rays in one array of dtype RAY, which is read in place. Any
    strides; float64 is rounded to float32. directions: (N, 3) or (3,); they need not have unit length.
    tmin, tmax: hits have tmin < t <= tmax, in units of the direction's length; one number, or (N,).
    masks: (N,) a ray sees geometries whose mask shares a bit with its own.
    cull_back_faces: hit only triangles whose vertices appear counter-clockwise.
    closed: rays that only touch a surface, at its border or at an edge seen from the side, hit it.
    coherence: whether neighbouring rays have similar directions; affects speed only.
    nan: "raise": a ray that is not finite is an error; "miss": it hits nothing.
    out: an array of N elements of dtype HIT to be filled, as of an earlier call.

    Returns N hits of dtype HIT: hits['t'] (distance; tmax on a miss), 'u', 'v' (weights of the triangle's second and
    third vertex), 'primitive' (index of the triangle; MISS on a miss) and 'geometry'. A ray through an edge or a vertex
    hits exactly one of the triangles that share it (closed: any of them).

    Releases the GIL. Raises UsageError, naming the argument, for wrong shapes, types and values.
    """
    query = _query_of(bvh, "closest", cull_back_faces, closed, coherence)
    return query(origins, directions, tmin=tmin, tmax=tmax, masks=masks, nan=nan, out=out)


def any_hit(bvh: Bvh, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
            tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, cull_back_faces: bool = False, closed: bool = False,
            coherence: Coherence = "automatic", nan: Literal["raise", "miss"] = "raise",
            out: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
    """Returns for every ray whether it hits anything, as N bool. Arguments and errors are those of closest_hit."""
    query = _query_of(bvh, "any", cull_back_faces, closed, coherence)
    return query(origins, directions, tmin=tmin, tmax=tmax, masks=masks, nan=nan, out=out)


def unoccluded(bvh: Bvh, points: ArrayLike, targets: ArrayLike, *, offset: float = 1e-4) -> NDArray[np.bool_]:
    """Returns for every pair whether the segment between them is free.

    points, targets: (N, 3), or (3,) for all. offset: the share of the segment that is left out at both ends, so that the
    surfaces on which the points lie do not count.
    """
    starts, ends = _pair(points, targets)
    return ~any_hit(bvh, starts, ends.astype(np.float64) - starts, tmin=offset, tmax=1 - offset)
