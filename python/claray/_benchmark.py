"""How fast a machine is."""

from __future__ import annotations

import time
from typing import Any, Callable, NamedTuple

import numpy as np

from . import _native
from ._arrays import integer
from ._bvh import Bvh
from ._device import AnyDevice, device_of
from ._points import nearest_point
from ._query import any_hit, closest_hit
from ._render import Renderer, native_scene
from ._scene import Scene, load

_RUNS, _SECONDS = 7, 0.4
"""At most so many runs of each task, and not another one after so many seconds."""
_SIDE, _SAMPLES = 256, 4


class Measurement(NamedTuple):
    """The time of a task. rate: in millions of `unit` per second. runs: after a warm-up; seconds: their median."""

    name: str
    seconds: float
    rate: float
    unit: str
    runs: int


class Benchmark:
    """What benchmark() measured. benchmark["build"] is the measurement of this name; print it for a table."""

    def __init__(self, device: str, scene: str, triangles: int, measurements: tuple[Measurement, ...]) -> None:
        self.device, self.scene, self.triangles, self.measurements = device, scene, triangles, measurements

    def __getitem__(self, name: str) -> Measurement:
        for measurement in self.measurements:
            if measurement.name == name:
                return measurement
        raise KeyError(f"{name!r}; use one of {', '.join(m.name for m in self.measurements)}")

    def __repr__(self) -> str:
        width = max(len(m.name) for m in self.measurements)
        lines = [f"{m.name:<{width}} {1e3 * m.seconds:9.2f} ms {m.rate:9.2f} M{m.unit}/s" for m in self.measurements]
        title = f"claray {_native.version} on {self.device}, {self.scene} of {self.triangles:,} triangles"
        return "\n".join([title, *lines])


def benchmark(device: AnyDevice = None, *, scene: Scene | str = "spheres", rays: int = 2**19) -> Benchmark:
    """Measures how fast a device answers queries and renders, in a few seconds.

    device: as of Bvh. scene: a Scene, or the name of one as of load. rays: how many rays a query has; nearest points are a
    quarter as many.

    Each time is the median of up to 7 runs after a warm-up, in which kernels are compiled. Times are those of calls from Python
    with arrays of the host: they contain the checks of the arguments, and the copies of rays, points and results to the
    device and back.

    - build, fast build, high build: a Bvh of the scene by the builders "automatic", "fast" and "high", in triangles.
    - closest hits, in order: rays of the scene's camera, row by row. closest hits, random; any hits, random: rays of random origins in
      the scene's box and random directions, in no order. Trees do not learn.
    - nearest points: of random points in the box.
    - render: an image of 256 x 256 pixels with 4 samples each, in samples; the structure is built before.

    Returns a Benchmark, whose repr is a table. Raises UsageError, naming the argument, InputError and DeviceError.
    """
    opened = device_of(device)
    given = scene if isinstance(scene, Scene) else load(scene)
    count = integer("rays", rays, 1, 2**28)
    native_scene(given).validate()
    bvh = Bvh(given, device=opened, learns=False)
    ordered, random = _camera_rays(given, count), _random_rays(given, count)
    points = random[0][: (count + 3) // 4]

    def build(builder: str) -> Callable[[], Callable[[], Any]]:
        return lambda: lambda: Bvh(given, device=opened, builder=builder, learns=False).is_replaced

    def render() -> Callable[[], Any]:
        return Renderer(given, device=opened, width=_SIDE, height=_SIDE, spp=_SAMPLES).render

    tasks: list[tuple[str, int, str, Callable[[], Callable[[], Any]]]] = [
        ("build", bvh.triangle_count, "triangles", build("automatic")),
        ("fast build", bvh.triangle_count, "triangles", build("fast")),
        ("high build", bvh.triangle_count, "triangles", build("high")),
        ("closest hits, in order", count, "rays", lambda: lambda: closest_hit(bvh, *ordered)),
        ("closest hits, random", count, "rays", lambda: lambda: closest_hit(bvh, *random)),
        ("any hits, random", count, "rays", lambda: lambda: any_hit(bvh, *random)),
        ("nearest points", len(points), "points", lambda: lambda: nearest_point(bvh, points)),
        ("render", _SIDE * _SIDE * _SAMPLES, "samples", render),
    ]
    return Benchmark(opened.name, given.name, bvh.triangle_count, tuple(_measured(*task) for task in tasks))


def _measured(name: str, amount: int, unit: str, prepare: Callable[[], Callable[[], Any]]) -> Measurement:
    """The median time of what `prepare` returns, whose own time does not count."""
    times: list[float] = []
    prepare()()
    begin = time.perf_counter()
    while len(times) < _RUNS and (not times or time.perf_counter() - begin < _SECONDS):
        task = prepare()
        start = time.perf_counter()
        task()
        times.append(time.perf_counter() - start)
    median = float(np.median(times))
    return Measurement(name, median, 1e-6 * amount / median, unit, len(times))


def _camera_rays(scene: Scene, count: int) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """The origin of the scene's camera, and directions (count, 3) of a square image, row by row."""
    camera = scene.camera
    position, forward = np.array(camera.position, np.float64), np.subtract(camera.target, camera.position)
    right = np.cross(forward, (0, 1, 0) if abs(forward[0]) + abs(forward[2]) > 0 else (1, 0, 0))
    up = np.cross(right, forward)
    side = int(np.ceil(np.sqrt(count)))
    across = np.tan(np.radians(0.5 * camera.vertical_fov)) * np.linalg.norm(forward) * np.linspace(-1, 1, side)
    directions = (forward + across[None, :, None] * right / np.linalg.norm(right)
                  - across[:, None, None] * up / np.linalg.norm(up))
    return position.astype(np.float32), directions.reshape(-1, 3)[:count].astype(np.float32)


def _random_rays(scene: Scene, count: int) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    generator = np.random.default_rng(1)
    low, high = scene.bounds
    return generator.uniform(low, high, (count, 3)).astype(np.float32), generator.normal(size=(count, 3)).astype(np.float32)
