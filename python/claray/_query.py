"""Queries: the closest hit of each ray, and whether a ray hits anything."""

from __future__ import annotations

from typing import Any, Iterable, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import (HIT, INSTANCE_HIT, NO_FLOATS, RAY, Origin, Shape, as_array, check_choice, distances, flag, local, number, origin_of,
                      output, pointer, vectors, words)
from ._bvh import Bvh
from ._device import Device, Event, native_events
from ._filter import NO_FILTER, Filter
from ._handle import Handle
from ._instances import InstancedBvh
from ._primitives import Primitives
from .errors import UsageError

Coherence = Literal["automatic", "coherent", "incoherent"]
Structure = Union[Bvh, InstancedBvh, Primitives]
_COHERENCE = {"automatic": 0, "coherent": 1, "incoherent": 2}


class Query(Handle):
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

    __slots__ = ("_dtype", "_moves", "_native", "_of", "_origin")
    _instead_of_pickling = "make it in each process"

    def __init__(self, bvh: Structure, kind: Literal["closest", "any"] = "closest", *, cull_back_faces: bool = False,
                 closed: bool = False, coherence: Coherence = "automatic", brute_force: bool = False,
                 filter: Filter | None = None, queue: Device | None = None) -> None:
        _check_structure(bvh)
        self._of, self._moves = type(bvh), isinstance(bvh, InstancedBvh) and bvh.moves  # not bvh, which keeps queries
        self._origin = origin_of_structure(bvh)
        self._refuse({"cull_back_faces": cull_back_faces, "closed": closed, "filter": filter, "queue": queue})
        if queue is not None and not isinstance(queue, Device):
            raise UsageError(f"queue: is {queue!r}; use a device made by bvh.device.with_new_queue()")
        check_choice("kind", kind, ("closest", "any"))
        check_choice("coherence", coherence, tuple(_COHERENCE))
        self._dtype = np.dtype(bool) if kind == "any" else INSTANCE_HIT if isinstance(bvh, InstancedBvh) else HIT
        native_queue = (queue or bvh.device)._native
        self._native = _native.NativeQuery.make(
            bvh._native, native_queue, kind == "any", flag("cull_back_faces", cull_back_faces), flag("closed", closed),
            flag("brute_force", brute_force), _COHERENCE[coherence], native_filter(filter))

    def __call__(self, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
                 tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, times: ArrayLike | None = None,
                 nan: Literal["raise", "miss"] = "raise", out: NDArray[Any] | None = None) -> NDArray[Any]:
        """Traces rays of the host and waits for the results. See closest_hit."""
        check_choice("nan", nan, ("raise", "miss"))
        if directions is None:
            return self._trace_packed(origins, masks, times, nan, out)
        starts, towards, shape = _pair("origins", origins, "directions", directions)
        starts = local(starts, self._origin)
        low, high = _ends(tmin, tmax, shape)
        per_ray = self._per_ray(masks, times, shape)
        results = output("out", out, shape, self._dtype)
        if results.size:
            _refuse_bad(self._native.run_columns(starts, towards, low, high, *per_ray, _bytes(results)), starts, nan)
        return results

    def _per_ray(self, masks: ArrayLike | None, times: ArrayLike | None, shape: Shape) -> tuple[NDArray[Any], NDArray[Any]]:
        self._refuse({"masks": masks, "times": times})
        if times is None:
            return words("masks", masks, shape), NO_FLOATS
        at = distances("times", times, shape)
        if at.size and not (0 <= at.min() and at.max() <= 1):
            raise UsageError("times: holds numbers outside 0 to 1")
        return words("masks", masks, shape), np.ascontiguousarray(at, np.float32)

    def _refuse(self, options: dict[str, Any]) -> None:
        """Refuses options that queries of this structure do not have."""
        for name, value in options.items():
            if value is None or value is False:
                continue
            if name == "times" and not self._moves:
                raise UsageError("times: the structure does not move; give `ends` to a claray.InstancedBvh")
            if issubclass(self._of, Primitives) or issubclass(self._of, InstancedBvh) and name == "filter":
                raise UsageError(f"{name}: not for queries of {self._of.__name__}; use a claray.Bvh")

    def _trace_packed(self, rays: ArrayLike, masks: ArrayLike | None, times: ArrayLike | None, nan: str,
                      out: NDArray[Any] | None) -> NDArray[Any]:
        check = nan == "raise" and not getattr(rays, "_checked", False)
        _check_origin(rays, self._origin)
        packed, shape = _packed(rays)
        per_ray = self._per_ray(masks, times, shape)
        results = output("out", out, shape, self._dtype)
        if results.size:
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

    def __repr__(self) -> str:
        kind = "any" if self._dtype == bool else "closest"
        return f"<claray.Query of the {kind} hit in a {self._of.__name__} on {self._native.device().info()['name']}>"


def _check_structure(bvh: Any) -> None:
    if not isinstance(bvh, (Bvh, InstancedBvh, Primitives)):
        raise UsageError(f"bvh: is a {type(bvh).__name__}; use a claray.Bvh, InstancedBvh or Primitives")


def native_filter(filter: Filter | None) -> Any:
    if filter is not None and not isinstance(filter, Filter):
        raise UsageError(f"filter: is a {type(filter).__name__}; use a claray.Filter")
    return NO_FILTER if filter is None else filter._native


def _bytes(results: NDArray[Any]) -> NDArray[np.uint8]:
    return results.reshape(-1).view(np.uint8).reshape(results.size, results.dtype.itemsize)


def _ends(tmin: ArrayLike, tmax: ArrayLike, shape: Shape) -> tuple[NDArray[Any], NDArray[Any]]:
    low, high = _end("tmin", tmin, shape), _end("tmax", tmax, shape)
    if low.size and low.min() < 0:
        raise UsageError("tmin: holds a negative number")
    return low, high


def _end(name: str, value: ArrayLike, shape: Shape) -> NDArray[Any]:
    """One element for all rays, which takes a tenth of the time of an array for few rays, or one for each."""
    if isinstance(value, float) and value == value:
        return np.array((value,), np.float64)
    return distances(name, value, shape)


def _refuse_bad(row: int, starts: NDArray[Any], nan: str) -> None:
    if row < 0 or nan != "raise":
        return
    with np.errstate(over="ignore"):
        name = "directions" if np.isfinite(starts[row].astype(np.float32)).all() else "origins"
    raise UsageError(f"{name}: row {row} is not finite in float32; remove it, or pass nan='miss'")


def _refuse_bad_packed(row: int) -> None:
    if row >= 0:
        raise UsageError(f"rays: the origin or direction of row {row} is not finite; remove it, or pass nan='miss'")


def _pair(start_name: str, starts: ArrayLike, end_name: str, ends: ArrayLike) -> tuple[NDArray[Any], NDArray[Any], Shape]:
    """Two times vectors of shape (N, 3), and the shape of the results; one may be a single vector for all."""
    given = as_array(start_name, starts), as_array(end_name, ends)
    one_start, one_end = given[0].ndim == 1, given[1].ndim == 1
    first, shape = vectors(start_name, given[0][None] if one_start else given[0])
    second, end_shape = vectors(end_name, given[1][None] if one_end else given[1])
    if one_start:
        return np.broadcast_to(first, second.shape), second, end_shape
    if one_end:
        return first, np.broadcast_to(second, first.shape), shape
    if shape != end_shape:
        raise UsageError(f"{end_name}: has {_counted(end_shape)}, but {start_name} has {_counted(shape)}")
    return first, second, shape


def _counted(shape: Shape) -> str:
    return " x ".join(map(str, shape)) + " rows"


def _packed(rays: ArrayLike) -> tuple[NDArray[np.float32], Shape]:
    """Rays as float32 of shape (N, 8), and the shape of the results."""
    array = as_array("rays", rays)
    if array.dtype == RAY and array.ndim >= 1:
        array = np.ascontiguousarray(array)
        array = array.view(np.ndarray).reshape(-1).view(np.float32).reshape(*array.shape, 8)
    if array.dtype != np.float32 or array.ndim < 2 or array.shape[-1] != 8:
        raise UsageError(f"rays: has dtype {array.dtype} and shape {array.shape}; give origins and directions, or an array "
                         "of dtype claray.RAY, or float32 of shape (N, 8)")
    return np.ascontiguousarray(array.reshape(-1, 8)), array.shape[:-1]


class Rays(np.ndarray):
    """Rays of dtype RAY that rays() has checked, which is why the array is read-only. A copy is an ordinary array."""

    _checked = False
    _origin: Origin = None

    def __array_finalize__(self, source: Any) -> None:
        self._checked = isinstance(source, Rays) and source._checked and self.base is not None
        self._origin = source._origin if isinstance(source, Rays) else None


def origin_of_structure(bvh: Any) -> Origin:
    return bvh._origin if isinstance(bvh, Bvh) else None


def _check_origin(rays: Any, origin: Origin) -> None:
    """Of rays in one array, which are not shifted. Those of another program are taken to be local."""
    zero = np.zeros(3)
    if isinstance(rays, Rays) and not np.array_equal(zero if rays._origin is None else rays._origin, zero if origin is None else origin):
        raise UsageError("rays: have another origin than the structure; pass origin=bvh.origin to claray.rays")


def rays(origins: ArrayLike, directions: ArrayLike, tmin: ArrayLike = 0.0, tmax: ArrayLike = np.inf, *,
         nan: Literal["raise", "miss"] = "raise", origin: ArrayLike | None = None) -> Rays:
    """A read-only array of dtype RAY, which queries read in place: for rays that are traced several times.

    The arguments are those of closest_hit. They are checked here, once. origin: bvh.origin of the structure that they are for.
    """
    check_choice("nan", nan, ("raise", "miss"))
    shift = origin_of(origin, np.empty((0, 3)))
    starts, towards, shape = _pair("origins", origins, "directions", directions)
    starts = local(starts, shift)
    low, high = _ends(tmin, tmax, shape)
    packed = np.empty(shape, RAY)
    if packed.size:
        _refuse_bad(_native.pack_rays(starts, towards, low, high, _packed(packed)[0]), starts, nan)
    packed.flags.writeable = False
    result = packed.view(Rays)
    result._checked, result._origin = True, shift
    return result


def packed_rays(bvh: Bvh, origins: ArrayLike, directions: ArrayLike | None, tmin: ArrayLike, tmax: ArrayLike,
                nan: str) -> tuple[NDArray[np.float32], Shape]:
    """Rays as float32 of shape (N, 8), checked, and the shape of the results."""
    if directions is not None:
        return _packed(rays(origins, directions, tmin, tmax, nan=nan, origin=bvh._origin))  # type: ignore[arg-type]  # rays() checks nan
    check_choice("nan", nan, ("raise", "miss"))
    _check_origin(origins, bvh._origin)
    packed, shape = _packed(origins)
    if nan == "raise" and not getattr(origins, "_checked", False):
        bad = np.flatnonzero(~np.isfinite(packed[:, [0, 1, 2, 4, 5, 6]]).all(axis=1))
        _refuse_bad_packed(int(bad[0]) if len(bad) else -1)
    return packed, shape


def _query_of(bvh: Structure, kind: Literal["closest", "any"], cull_back_faces: bool, closed: bool, coherence: Coherence,
              filter: Filter | None) -> Query:
    _check_structure(bvh)
    if filter is not None:  # the kernels stay loaded, and the query costs little
        return Query(bvh, kind, cull_back_faces=cull_back_faces, closed=closed, coherence=coherence, filter=filter)
    check_choice("coherence", coherence, tuple(_COHERENCE))
    key = (kind, flag("cull_back_faces", cull_back_faces), flag("closed", closed), coherence)
    if key not in bvh._queries:
        bvh._queries[key] = Query(bvh, kind, cull_back_faces=cull_back_faces, closed=closed, coherence=coherence)
    query: Query = bvh._queries[key]
    return query


def closest_hit(bvh: Structure, origins: ArrayLike, directions: ArrayLike | None = None, *, tmin: ArrayLike = 0.0,
                tmax: ArrayLike = np.inf, masks: ArrayLike | None = None, times: ArrayLike | None = None,
                cull_back_faces: bool = False, closed: bool = False, filter: Filter | None = None,
                coherence: Coherence = "automatic", nan: Literal["raise", "miss"] = "raise",
                out: NDArray[Any] | None = None) -> NDArray[Any]:
    """Finds the closest hit of every ray.

    bvh: a Bvh, InstancedBvh or Primitives.
    origins: (N, 3) numbers, or (3,) for all rays; or rays in one array of dtype RAY, which is read in place. Any
    strides; float64 is rounded to float32, relative to bvh.origin if there is one. directions: (N, 3) or (3,); they need not
    have unit length. Rays may be in any shape, such as (H, W, 3); results, and what is given for each ray, then have the
    shape (H, W).
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

    points, targets: (N, 3) or another shape, such as (H, W, 3); or (3,) for all. offset: the share of the segment that is left out at both ends, so that the
    surfaces on which the points lie do not count.
    """
    starts, ends, shape = _pair("points", points, "targets", targets)
    share = number("offset", offset)
    if not 0 <= share < 0.5:
        raise UsageError(f"offset: is {share}; use a share from 0 to less than 0.5")
    return ~any_hit(bvh, starts, ends.astype(np.float64) - starts, tmin=share, tmax=1 - share).reshape(shape)
