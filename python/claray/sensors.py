"""Sensors: lidars, depth cameras and radars in scenes that move. See docs/sensors.md.

```python
world = sensors.World(scene)
lidar = sensors.Sensor(world, sensors.spinning(numpy.linspace(15, -25, 64), 1024), farthest=120)
scan = lidar.scan(pose)
scan.points, scan.returns["intensity"]
```

Lengths are in units of the scene, taken for metres; angles in degrees, times in seconds. A lidar's and a radar's frame has x
forwards, y to the left and z up; a camera's has z forwards, x to the right and y down (REP 103 of ROS).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Iterable, Literal, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import MISS, NO_FLOATS, NO_WORDS, as_array, builder_called, check_choice, finite, flag, floats, integer, names_of, number, output, words
from ._device import AnyDevice, Device, device_of
from ._handle import Handle
from ._records import set_all
from ._scene import Scene
from ._transforms import rows_of
from .errors import UsageError

__all__ = ["RETURN", "Pattern", "PointCloud2", "PointField", "Scan", "Sensor", "World", "camera", "look_at", "radar", "raster", "rosette",
           "spinning"]

RETURN = np.dtype([("point", "3f4"), ("intensity", "f4"), ("range", "f4"), ("velocity", "f4"), ("time", "f4"), ("share", "f4"),
                   ("normal", "3f4"), ("material", "u4"), ("instance", "u4"), ("primitive", "u4"), ("ring", "u4"), ("column", "u4")])
"""A return: 64 bytes. Without one, point, range and velocity are NaN; intensity, share and normal are 0; material, instance and
primitive are claray.MISS."""


def _count(name: str, value: Any, least: int = 1, most: int = 2**32 - 1) -> int:
    return integer(name, value, least, most)


def _angles(name: str, value: Any) -> NDArray[np.float64]:
    array = np.atleast_1d(as_array(name, value))
    if array.dtype.kind not in "fiu" or array.ndim != 1:
        raise UsageError(f"{name}: has dtype {array.dtype} and shape {array.shape}; use angles in degrees, of shape (N,)")
    if array.size == 0:
        raise UsageError(f"{name}: is empty; use at least one angle in degrees")
    return np.radians(array.astype(np.float64))


def _numbers(name: str, value: Any, counts: Iterable[int]) -> NDArray[np.float64]:
    array = np.ravel(as_array(name, value))
    if array.size not in counts or array.size and (array.dtype.kind not in "fiu" or not np.isfinite(array).all()):
        raise UsageError(f"{name}: is {value!r}; use {' or '.join(map(str, counts))} finite numbers")
    return array.astype(np.float64)


class Pattern:
    """The beams of a sensor, in rows and columns: the rings of a lidar, or the rows of an image.

    directions: (rows, columns, 3), or (N, 3) for one row; they are normalised in float64, and those of zero are never sent.
    times: (rows, columns), or (N,): when each beam is sent, from 0 to 1 within a scan; or one number for all.
    Raises UsageError, naming the argument, for other shapes and values that are not finite.
    """

    __slots__ = ("_beams", "_rows", "_columns")
    _beams: NDArray[np.float32]
    _rows: int
    _columns: int

    def __init__(self, directions: ArrayLike, times: ArrayLike = 0.0) -> None:
        given = as_array("directions", directions)
        if given.ndim not in (2, 3) or given.shape[-1] != 3 or given.dtype.kind not in "fiu" or given.size == 0:
            raise UsageError(f"directions: has dtype {given.dtype} and shape {given.shape}; use numbers of shape (rows, columns, 3) or (N, 3)")
        grid = given.shape[:-1] if given.ndim == 3 else (1, len(given))
        vectors = given.reshape(-1, 3).astype(np.float64)
        finite("directions", vectors)
        lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
        when = as_array("times", times)
        if when.dtype.kind not in "fiu" or when.ndim != 0 and when.shape != given.shape[:-1]:
            raise UsageError(f"times: has dtype {when.dtype} and shape {when.shape}; use one number, or {given.shape[:-1]}")
        if when.size and not (when.min() >= 0 and when.max() <= 1):
            raise UsageError("times: holds numbers outside 0 to 1")
        self._rows, self._columns = grid
        self._beams = np.empty((len(vectors), 4), np.float32)
        self._beams[:, :3] = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
        self._beams[:, 3] = np.ravel(when)

    @classmethod
    def _of(cls, arrays: tuple[int, int, NDArray[np.float32]]) -> Pattern:
        pattern = cls.__new__(cls)
        pattern._rows, pattern._columns, pattern._beams = arrays
        return pattern

    @property
    def rows(self) -> int:
        return self._rows

    @property
    def columns(self) -> int:
        return self._columns

    @property
    def directions(self) -> NDArray[np.float32]:
        """(rows, columns, 3) of unit length, in the frame of the sensor."""
        return self._beams[:, :3].reshape(self.rows, self.columns, 3)

    @property
    def times(self) -> NDArray[np.float32]:
        """(rows, columns) from 0 to 1."""
        return self._beams[:, 3].reshape(self.rows, self.columns)

    def __repr__(self) -> str:
        return f"<claray.sensors.Pattern of {self.rows} x {self.columns} beams>"


def spinning(elevations: ArrayLike, columns: int, *, begin: float = 180.0, turn: float = -360.0) -> Pattern:
    """A lidar that turns round z: a ring of `columns` beams for each of its elevations, in degrees above the horizon.

    begin: azimuth of the first column, from x (0) towards y (90). turn: how far it turns in a scan; below 0: clockwise from
    above. All elevations of a column are sent at once.
    """
    return Pattern._of(_native.spinning_beams(_angles("elevations", elevations), _count("columns", columns),
                                              math.radians(number("begin", begin)), math.radians(number("turn", turn))))


def raster(rows: int, columns: int, *, horizontal_fov: float = 120.0, vertical_fov: float = 25.0) -> Pattern:
    """A solid-state lidar: rows from the top, each from left to right, one beam after the other, at evenly spaced angles."""
    return Pattern._of(_native.raster_beams(_count("rows", rows), _count("columns", columns),
                                            math.radians(number("horizontal_fov", horizontal_fov)),
                                            math.radians(number("vertical_fov", vertical_fov))))


def rosette(beams: int, *, fov: float = 38.4, first: float = 121.63, second: float = -77.84, phase: float = 0.0) -> Pattern:
    """A solid-state lidar with two prisms that turn, in the first-order theory of Risley prisms (Marshall 1999, "Risley prism
    scan patterns").

    fov: the cone's full angle. first, second: turns of the prisms in a scan; no common period fills the cone in the long run.
    phase: the number of scans before this one; a fraction shifts the begin.
    """
    return Pattern._of(_native.rosette_beams(_count("beams", beams), math.radians(number("fov", fov)), number("first", first),
                                             number("second", second), number("phase", phase)))


def camera(width: int, height: int, *, vertical_fov: float | None = None, focal: Sequence[float] | float | None = None,
           center: Sequence[float] | None = None, lens: Literal["pinhole", "equidistant"] = "pinhole",
           distortion: Sequence[float] = (), shutter: float = 0.0) -> Pattern:
    """The pixels of a camera, for images of depth, normals and materials.

    focal: focal lengths in pixels, one or two; or vertical_fov of the undistorted image, in degrees. center: of the image, in
    pixels, where (0, 0) is the centre of the first one; None: the middle. lens: "pinhole" with k1, k2, p1, p2, k3 (Brown
    1966), or "equidistant", a fisheye lens, with k1, k2, k3, k4 (Kannala and Brandt 2006), both as in OpenCV. shutter: the
    part of a scan from the first to the last row; 0: all rows at once. Pixels that the lens does not reach never have a return.
    """
    across, down = _count("width", width), _count("height", height)
    check_choice("lens", lens, ("pinhole", "equidistant"))
    if (focal is None) == (vertical_fov is None):
        raise UsageError("focal: give either the focal length in pixels or vertical_fov")
    if focal is None:
        half = math.radians(number("vertical_fov", vertical_fov)) / 2
        if not 0 < half < (math.pi / 2 if lens == "pinhole" else math.pi + 1e-9):
            raise UsageError(f"vertical_fov: is {vertical_fov!r}; use an angle above 0 that the lens can have")
        focal = down / 2 / (math.tan(half) if lens == "pinhole" else half)
    lengths = _numbers("focal", focal, (1, 2))
    middle = _numbers("center", ((across - 1) / 2, (down - 1) / 2) if center is None else center, (2,))
    bent = _numbers("distortion", distortion, range(6 if lens == "pinhole" else 5))
    return Pattern._of(_native.camera_beams(across, down, lens, [float(lengths[0]), float(lengths[-1]), *map(float, middle)], bent.tolist(),
                                            number("shutter", shutter)))


def look_at(position: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0), *, optical: bool = False) -> NDArray[np.float64]:
    """A pose, (4, 4): at `position`, forwards to `target`. optical: for cameras, whose z is forwards."""
    along_z = flag("optical", optical)
    where, to, above = (np.asarray(floats(name, as_array(name, value)[None], 3)[0], np.float64)
                        for name, value in (("position", position), ("target", target), ("up", up)))
    ahead, left = to - where, np.cross(above, to - where)
    if not np.linalg.norm(left) > 0:
        raise UsageError("target: lies at the position, or above or below it; choose another target or `up`")
    ahead, left = ahead / float(np.linalg.norm(ahead)), left / float(np.linalg.norm(left))
    upwards = np.cross(ahead, left)
    pose = np.eye(4)
    pose[:3] = np.stack([-left, -upwards, ahead, where] if along_z else [ahead, left, upwards, where], axis=1)
    return pose


def _poses(name: str, value: Any, count: int | None = None) -> NDArray[np.float64]:
    """(N, 4, 4) float64; the library checks that they are rotations with translations."""
    array = as_array(name, value)
    if array.dtype.kind not in "fiu" or array.ndim not in (2, 3) or array.shape[-2:] != (4, 4):
        raise UsageError(f"{name}: has dtype {array.dtype} and shape {array.shape}; use matrices of shape (4, 4) or (N, 4, 4)")
    array = np.ascontiguousarray(array.reshape(-1, 4, 4), np.float64)
    if count is not None and len(array) != count:
        raise UsageError(f"{name}: has {len(array)} matrices, but pose has {count}")
    return array


class World(Handle):
    """What sensors see: the triangles of a scene, some of which move.

    movers: (M,) numbers of the instances that may move, in scene.instances; those that move in the scene may, too.
    reflectances: (materials,) relative to a white surface that scatters evenly, at the wavelength of the sensors; above 1 for
    reflectors. None: the red of their albedos, which is nearest to infrared. device, builder: as of Bvh.

    Primitives and cut-outs are not seen. Raises UsageError, naming the argument, for wrong shapes, types and values.
    """

    __slots__ = ("_device", "_native", "_movers")
    _instead_of_pickling = "build it in each process"

    def __init__(self, scene: Scene, *, movers: ArrayLike | None = None, reflectances: ArrayLike | None = None, device: AnyDevice = None,
                 builder: str = "automatic") -> None:
        if not isinstance(scene, Scene):
            raise UsageError(f"scene: is a {type(scene).__name__}; use a claray.Scene")
        which = NO_WORDS if movers is None else words("movers", movers, np.shape(as_array("movers", movers))[:1])
        white = NO_FLOATS
        if reflectances is not None:
            given = as_array("reflectances", reflectances)
            if given.dtype.kind not in "fiu" or given.ndim != 1 or given.size == 0:
                raise UsageError(f"reflectances: has dtype {given.dtype} and shape {given.shape}; use one number for each material")
            white = np.ascontiguousarray(given, np.float32)
        self._device = device_of(device)
        self._native = _native.NativeSensorWorld.build(self._device._native, scene._native, which, white, builder_called(builder))
        self._movers = np.array(self._native.movers(), np.uint32)

    @property
    def movers(self) -> NDArray[np.uint32]:
        """Numbers of the instances that may move, in increasing order."""
        return self._movers

    @property
    def triangle_count(self) -> int:
        """Of all instances."""
        return self._native.triangle_count()

    @property
    def device(self) -> Device:
        return self._device

    def move(self, transforms: ArrayLike, ends: ArrayLike | None = None) -> None:
        """Places all movers: (M, 4, 4) or (M, 3, 4), where they are when the following scans begin. ends: the same when they
        end; None: they stand still. Matrices in between are interpolated linearly."""
        begin = rows_of("transforms", transforms)
        self._native.move(begin, begin if ends is None else rows_of("ends", ends))

    def __repr__(self) -> str:
        return f"<claray.sensors.World of {self.triangle_count} triangles with {len(self._movers)} movers on {self._device.name}>"


class Sensor(Handle):
    """A sensor in a world.

    pattern: its beams. rays: of a beam, 1 to 64; several find edges within a beam. returns: most of a beam, up to `rays`.
    order: which are kept, and how they are sorted: "strongest", "first" or "last".
    divergence: full angle of a beam in degrees, at which its power falls to 1/e^2; or two, to the sides and up.
    nearest, farthest: ranges that are measured; what is nearer still hides what is behind.
    range_resolution, velocity_resolution: surfaces of a beam within these become one return.
    range_noise, velocity_noise: standard deviations, m and m/s; intensity_noise: relative to the intensity.
    dropout: probability that a return is lost. least_intensity: weaker returns are lost.
    reference_range: where a white surface has the intensity 1; 0: intensities do not fall with the range. extinction: of the
    air, per m. duration: of a scan, in seconds; 0: velocities are 0. seed: of noise and dropouts.
    frame: "sensor": points and normals in the frame of the sensor when it sends each beam; or "world".

    docs/sensors.md has the formulas. Raises UsageError, naming the argument, for values that do not fit.
    """

    __slots__ = ("_world", "_pattern", "_native", "_returns")
    _instead_of_pickling = "make it in each process"

    def __init__(self, world: World, pattern: Pattern, *, rays: int = 1, returns: int = 1,
                 order: Literal["strongest", "first", "last"] = "strongest", divergence: float | Sequence[float] = 0.0,
                 nearest: float = 0.0, farthest: float = 1000.0, range_resolution: float = 0.1, velocity_resolution: float = math.inf,
                 range_noise: float = 0.0, velocity_noise: float = 0.0, intensity_noise: float = 0.0, dropout: float = 0.0,
                 reference_range: float = 1.0, extinction: float = 0.0, least_intensity: float = 0.0, duration: float = 0.1,
                 frame: Literal["sensor", "world"] = "sensor", seed: int = 0) -> None:
        if not isinstance(world, World):
            raise UsageError(f"world: is a {type(world).__name__}; use a claray.sensors.World")
        if not isinstance(pattern, Pattern):
            raise UsageError(f"pattern: is a {type(pattern).__name__}; use a claray.sensors.Pattern")
        check_choice("frame", frame, ("sensor", "world"))
        check_choice("order", order, ("strongest", "first", "last"))
        degrees = _numbers("divergence", divergence, (1, 2))
        if (degrees < 0).any() or (degrees > 57).any():
            raise UsageError(f"divergence: is {divergence!r}; use degrees from 0 to 57")
        angles = np.radians(degrees)
        numbers = {name: number(name, value) for name, value in (
            ("nearest", nearest), ("farthest", farthest), ("range_resolution", range_resolution),
            ("velocity_resolution", velocity_resolution), ("range_noise", range_noise), ("velocity_noise", velocity_noise),
            ("intensity_noise", intensity_noise), ("dropout", dropout), ("reference_range", reference_range), ("extinction", extinction),
            ("least_intensity", least_intensity), ("duration", duration))}
        config = set_all(_native.NativeSensorConfig(), "Sensor", {
            "rays": _count("rays", rays, most=64), "returns": _count("returns", returns), "order": order,
            "divergence": [float(angles[0]), float(angles[-1])], "in_world": frame == "world", "seed": _count("seed", seed, 0), **numbers})
        config.set_pattern(pattern.rows, pattern.columns, pattern._beams)
        self._world, self._pattern, self._returns = world, pattern, int(returns)
        self._native = _native.NativeSensor.make(world.device._native, config)

    @property
    def world(self) -> World:
        return self._world

    @property
    def pattern(self) -> Pattern:
        return self._pattern

    def scan(self, pose: ArrayLike, pose_end: ArrayLike | None = None, *, number: int = 0) -> Scan:
        """Scans the world.

        pose: (4, 4), from the frame of the sensor to the world, or (N, 4, 4) for N sensors at once. pose_end: the same at the
        end of the scan; None: they stand still. number: of the scan; noise is a function of the seed, of this number, and of
        the indices of sensor and beam. The device works on while Python continues; what reads the scan waits for it.
        """
        begin = _poses("pose", pose)
        end = begin if pose_end is None else _poses("pose_end", pose_end, len(begin))
        native = self._native.scan(self._world._native, begin, end, _count("number", number, 0))
        several = np.ndim(pose) == 3
        grid = (self._pattern.rows, self._pattern.columns, self._returns)
        return Scan._of(native, self._pattern, (len(begin), *grid) if several else grid)

    def __repr__(self) -> str:
        return f"<claray.sensors.Sensor of {self._pattern.rows} x {self._pattern.columns} beams, {self._returns} returns each>"


def radar(world: World, *, beams: int = 60, horizontal_fov: float = 120.0, divergence: Sequence[float] = (2.0, 15.0), rays: int = 64,
          returns: int = 8, range_resolution: float = 0.5, velocity_resolution: float = 0.2, **options: Any) -> Sensor:
    """A radar: a fan of beams, sent at once, whose returns are apart in range or in velocity. options: those of Sensor.

    Each ray's power falls with the square of the range, and so does the number of rays that meet a small target: together
    with the fourth power of the range, as in the radar equation. Reflectances stand for radar cross-sections.
    """
    pattern = raster(1, integer("beams", beams, 1, 2**31 - 1), horizontal_fov=horizontal_fov, vertical_fov=0.0)
    return Sensor(world, Pattern(pattern.directions, 0.0), rays=rays, returns=returns, divergence=divergence,
                  range_resolution=range_resolution, velocity_resolution=velocity_resolution, **options)


@dataclass(frozen=True)
class PointField:
    """As sensor_msgs/msg/PointField. datatype: 6 is UINT32, 7 is FLOAT32."""

    name: str
    offset: int
    datatype: int
    count: int = 1


@dataclass(frozen=True)
class PointCloud2:
    """As sensor_msgs/msg/PointCloud2, without a header. data: (height * row_step,) uint8."""

    height: int
    width: int
    fields: tuple[PointField, ...]
    is_bigendian: bool
    point_step: int
    row_step: int
    data: NDArray[np.uint8]
    is_dense: bool


_FIELDS = {"x": ("point", 0), "y": ("point", 1), "z": ("point", 2), "normal_x": ("normal", 0), "normal_y": ("normal", 1), "normal_z": ("normal", 2)}


class Scan:
    """The returns of a scan, on the device until they are read."""

    __slots__ = ("_native", "_pattern", "_shape", "_read")
    _native: Any
    _pattern: Pattern
    _shape: tuple[int, ...]
    _read: NDArray[Any] | None

    def __init__(self) -> None:
        raise UsageError("Scan: scans are made by Sensor.scan")

    @classmethod
    def _of(cls, native: Any, pattern: Pattern, shape: tuple[int, ...]) -> Scan:
        scan = cls.__new__(cls)
        scan._native, scan._pattern, scan._shape = native, pattern, shape
        scan._read = None
        return scan

    @property
    def shape(self) -> tuple[int, ...]:
        """(rows, columns, returns), or (N, rows, columns, returns) for N sensors at once."""
        return self._shape

    def read(self, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """All returns, with dtype RETURN: a new array, or `out`, of that dtype and of the scan's shape."""
        result = output("out", out, self._shape, RETURN)
        self._native.read(result.reshape(-1).view(np.uint8).reshape(-1, RETURN.itemsize))
        return result

    @property
    def returns(self) -> NDArray[Any]:
        """All returns, with dtype RETURN; read when it is first asked for."""
        if self._read is None:
            self._read = self.read()
        return self._read

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which of them are there, in the scan's shape."""
        valid: NDArray[np.bool_] = self.returns["instance"] != MISS
        return valid

    @property
    def points(self) -> NDArray[np.float32]:
        """(N, 3) of those that are there."""
        return self.returns["point"][self.valid]

    @property
    def depth(self) -> NDArray[np.float32]:
        """The range along the camera's axis z, in the scan's shape; NaN without a return."""
        depth: NDArray[np.float32] = self.returns["range"] * self._pattern.directions[..., 2:]
        return depth

    def point_cloud2(self, fields: Sequence[str] = ("x", "y", "z", "intensity", "ring", "time"), *, organized: bool = False) -> PointCloud2:
        """The returns in the layout of ROS 2.

        fields: x, y, z, intensity, range, velocity, time, share, normal_x, normal_y, normal_z, material, instance, primitive,
        ring and column: four bytes each. organized: a point for each return, in rows; those that are not there have NaN.
        Otherwise one row of those that are there. Several sensors follow each other.
        """
        names = names_of("fields", fields).split(",")
        known = [*_FIELDS, *(name for name in RETURN.names or () if name not in ("point", "normal"))]
        for name in names:
            if name not in known:
                raise UsageError(f"fields: unknown name {name!r}; use {', '.join(known)}")
        flat = self.returns.reshape(-1, self._shape[-2] * self._shape[-1])
        rows = flat if flag("organized", organized) else flat[self.valid.reshape(flat.shape)][None]
        data = np.empty((*rows.shape, len(names)), np.uint32)
        described: list[PointField] = []
        for i, name in enumerate(names):
            of, part = _FIELDS.get(name, (name, None))
            column = rows[of] if part is None else rows[of][..., part]
            data[..., i] = column.view(np.uint32)
            described.append(PointField(name, 4 * i, 7 if column.dtype == np.float32 else 6))
        step = 4 * len(names)
        return PointCloud2(rows.shape[0], rows.shape[1], tuple(described), False, step, step * rows.shape[1],
                           data.reshape(-1).view(np.uint8), bool(not organized or self.valid.all()))

    def __repr__(self) -> str:
        return f"<claray.sensors.Scan of {' x '.join(map(str, self._shape))} returns>"
