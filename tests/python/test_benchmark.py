"""claray.benchmark counts what it says, and its rays are those that it describes."""

import re
import time

import numpy as np
import pytest

import claray
from claray import _benchmark


@pytest.fixture(scope="module")
def measured():
    return claray.benchmark(scene="cornell", rays=5000)


def test_the_table_has_each_measurement(measured):
    scene = claray.load("cornell")
    lines = repr(measured).splitlines()
    assert measured.device in lines[0] and "cornell of 38 triangles" in lines[0] and scene.triangle_count == 38
    assert len(lines) == 1 + len(measured.measurements) == 9
    amounts = {"triangles": 38, "rays": 5000, "points": 1250, "samples": 256 * 256 * 4}
    for line, measurement in zip(lines[1:], measured.measurements):
        name, milliseconds, rate, unit = re.fullmatch(r"(.*?) +([\d.]+) ms +([\d.]+) M(\w+)/s", line).groups()
        assert (name, unit) == (measurement.name, measurement.unit) and measured[name] is measurement
        assert 1 <= measurement.runs <= 7 and measurement.seconds > 0
        assert measurement.rate * measurement.seconds == pytest.approx(1e-6 * amounts[unit])
        assert float(milliseconds) == pytest.approx(1e3 * measurement.seconds, abs=0.006)
        assert float(rate) == pytest.approx(measurement.rate, abs=0.006)
    with pytest.raises(KeyError, match="nearest points"):
        measured["nothing"]


def test_times_are_medians_without_the_warm_up_and_the_preparation():
    waits = iter([0.05, 0.001, 0.02, 0.001])  # the first is the warm-up

    def prepare():
        time.sleep(0.01)
        wait = next(waits)
        return lambda: time.sleep(wait)

    runs, _benchmark._RUNS = _benchmark._RUNS, 3
    try:
        measurement = _benchmark._measured("waits", 7, "waits", prepare)
    finally:
        _benchmark._RUNS = runs
    assert measurement.runs == 3 and 0.001 <= measurement.seconds < 0.01


def test_rays_see_the_scene():
    for name in ("cornell", "hills"):
        scene = claray.load(name)
        origin, directions = _benchmark._camera_rays(scene, 3000)
        assert directions.shape == (3000, 3)
        hits = claray.closest_hit(claray.Bvh(scene), origin, directions)["primitive"] != claray.MISS
        assert hits.mean() > 0.5
        unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        along = np.einsum("ij,ij->i", unit[1:], unit[:-1])
        assert np.median(along) > 0.999  # neighbours look the same way
        starts, towards = _benchmark._random_rays(scene, 3000)
        low, high = scene.bounds
        assert (starts >= low - 1e-4).all() and (starts <= high + 1e-4).all()
        assert abs(np.einsum("ij,ij->i", towards[1:], towards[:-1]).mean()) < 0.3


def test_wrong_arguments():
    with pytest.raises(claray.UsageError, match="^rays: "):
        claray.benchmark(rays=0)
    with pytest.raises(claray.UsageError, match="^device: "):
        claray.benchmark(2.5)
    with pytest.raises(claray.UsageError, match="nowhere"):
        claray.benchmark(scene="nowhere")
