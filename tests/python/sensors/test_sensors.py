"""claray.sensors: shapes, frames, lenses, motion, the layout of ROS 2, errors. tests/trace/sensors has the physics."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import claray
from claray import UsageError, sensors

BUILD = pathlib.Path(os.environ.get("PYTHONPATH", "").split(os.pathsep)[0]).parent


def box(low, high):
    x, y, z = np.array([low, high], float).T
    corners = np.array([[x[i & 1], y[i >> 1 & 1], z[i >> 2]] for i in range(8)])
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


@pytest.fixture(scope="module")
def room():
    """A room of 10 x 8 x 6 about the origin, and a box that may move."""
    scene = claray.Scene()
    scene.add_material(albedo=(0.8, 0.5, 0.5))
    scene.add_material(albedo=(0.25, 0.5, 0.5))
    scene.add_mesh(*box((-5, -4, -3), (5, 4, 3)))
    scene.add_mesh(*box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)), material=1)
    at = np.eye(4)
    at[0, 3] = 3
    scene.set_instances([0, 1], [np.eye(4), at])
    return sensors.World(scene, movers=[1])


def placed(*offset):
    matrix = np.eye(4)
    matrix[:3, 3] = offset
    return matrix


def exact_ranges(directions, half):
    with np.errstate(divide="ignore"):
        return (np.array(half) / np.abs(directions)).min(axis=-1)


def test_ranges_in_a_box_are_exact(room):
    room.move([placed(100, 0, 0)])
    pattern = sensors.spinning(np.linspace(40, -40, 16), 360)
    scan = sensors.Sensor(room, pattern).scan(np.eye(4))
    assert scan.shape == (16, 360, 1) and scan.valid.all() and scan.points.shape == (16 * 360, 3)
    exact = exact_ranges(pattern.directions.astype(float), (5, 4, 3))
    np.testing.assert_allclose(scan.returns["range"][..., 0], exact, rtol=1e-6)
    np.testing.assert_allclose(scan.returns["point"][..., 0, :], exact[..., None] * pattern.directions, atol=1e-5)
    assert (scan.returns["ring"][..., 0] == np.arange(16)[:, None]).all() and (scan.returns["column"][..., 0] == np.arange(360)).all()
    inwards = (scan.returns["normal"] * scan.returns["point"]).sum(-1)
    assert (inwards < 0).all() and set(np.unique(np.abs(scan.returns["normal"]))) == {0, 1}


def test_reflectance_is_the_materials(room):
    room.move([placed(3, 0, 0)])
    one = sensors.Sensor(room, sensors.Pattern([[1, 0, 0], [-1, 0, 0]]), reference_range=0).scan(np.eye(4))
    np.testing.assert_allclose(one.returns["intensity"][0, :, 0], [0.25, 0.8])
    assert one.returns["material"][0, :, 0].tolist() == [1, 0] and one.returns["instance"][0, :, 0].tolist() == [1, 0]
    falling = sensors.Sensor(room, sensors.Pattern([[1, 0, 0]]), reference_range=10, extinction=0.01).scan(np.eye(4))
    np.testing.assert_allclose(falling.returns["intensity"][0, 0, 0], 0.25 * (10 / 2.5) ** 2 * np.exp(-2 * 0.01 * 2.5), rtol=1e-6)


def test_rolling_shutter_displaces_a_mover(room):
    """The side of the box that a scan meets is where it was when each beam was sent."""
    room.move([placed(3, 0, 0)], [placed(3, 0.4, 0)])
    azimuth = np.linspace(-0.25, 0.25, 401)
    pattern = sensors.Pattern(np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], 1), np.linspace(0, 1, 401))
    met = sensors.Sensor(room, pattern).scan(np.eye(4)).returns["instance"][0, :, 0] == 1
    front = 2.5 * np.tan(azimuth)
    assert (met == (np.abs(front - 0.4 * np.linspace(0, 1, 401)) < 0.5)).all()
    still = sensors.Sensor(room, sensors.Pattern(pattern.directions[0])).scan(np.eye(4)).returns["instance"][0, :, 0] == 1
    assert still.sum() != met.sum() and (still == (np.abs(front) < 0.5)).all()


def test_velocity_is_relative(room):
    room.move([placed(3, 0, 0)], [placed(2.5, 0, 0)])
    sensor = sensors.Sensor(room, sensors.Pattern([[1, 0, 0], [0, 1, 0]]), duration=0.05)
    scan = sensor.scan(np.eye(4), placed(0.1, 0, 0))
    np.testing.assert_allclose(scan.returns["velocity"][0, :, 0], [-10 - 2, 0], atol=1e-5)


def test_depth_camera_sees_planes(room):
    room.move([placed(100, 0, 0)])
    pattern = sensors.camera(64, 48, vertical_fov=50)
    scan = sensors.Sensor(room, pattern).scan(sensors.look_at((0, 0, 0), (1, 0, 0), optical=True))
    np.testing.assert_allclose(scan.depth[..., 0], np.full((48, 64), 5), rtol=1e-6)
    np.testing.assert_allclose(scan.returns["normal"][24, 32, 0], [0, 0, -1], atol=1e-7)
    right = sensors.Sensor(room, pattern, frame="world").scan(sensors.look_at((0, 0, 0), (1, 0, 0), optical=True)).returns
    assert right["point"][0, 0, 0, 1] > 0 > right["point"][0, -1, 0, 1] and right["point"][0, 0, 0, 2] > 0 > right["point"][-1, 0, 0, 2]


def test_lenses_agree_with_their_formulas():
    pattern = sensors.camera(101, 81, focal=(90, 95), center=(50.5, 39.5), distortion=(-0.2, 0.05, 1e-3, -5e-4))
    x, y = (pattern.directions[..., i].astype(float) / pattern.directions[..., 2] for i in range(2))
    r2 = x * x + y * y
    radial = 1 - 0.2 * r2 + 0.05 * r2 * r2
    u, v = x * radial + 2e-3 * x * y - 5e-4 * (r2 + 2 * x * x), y * radial + 1e-3 * (r2 + 2 * y * y) - 1e-3 * x * y
    np.testing.assert_allclose(u * 90 + 50.5, np.broadcast_to(np.arange(101), (81, 101)), atol=1e-4)
    np.testing.assert_allclose(v * 95 + 39.5, np.broadcast_to(np.arange(81)[:, None], (81, 101)), atol=1e-4)
    fish = sensors.camera(101, 101, vertical_fov=180, lens="equidistant").directions.astype(float)
    angle = np.degrees(np.arctan2(np.hypot(fish[..., 0], fish[..., 1]), fish[..., 2]))
    np.testing.assert_allclose(angle[50], np.abs(np.arange(101) - 50) * 180 / 101, atol=1e-4)


def test_pixels_beyond_the_lens_have_no_return(room):
    wide = sensors.camera(40, 40, vertical_fov=360, lens="equidistant")
    scan = sensors.Sensor(room, wide, rays=3, divergence=0.1).scan(np.eye(4))
    lost = np.linalg.norm(wide.directions, axis=-1) == 0
    assert lost[0, 0] and not lost[20, 20] and (scan.valid[..., 0] == ~lost).all()


def test_a_thin_pole_gives_two_returns():
    scene = claray.Scene()
    scene.add_mesh(*box((10, -0.02, -3), (10.04, 0.02, 3)))
    scene.add_mesh(*box((20, -9, -9), (21, 9, 9)))
    scan = sensors.Sensor(sensors.World(scene), sensors.Pattern([[1, 0, 0]]), rays=61, returns=3, divergence=0.6, order="first").scan(np.eye(4))
    first, second, third = scan.returns[0, 0]
    assert abs(first["range"] - 10) < 0.01 and abs(second["range"] - 20) < 0.01 and third["instance"] == claray.MISS
    # The part of a Gaussian beam between two lines: half of its width is w, where the power is 1/e^2.
    from math import erf, sqrt, tan, radians
    w = 10 * tan(radians(0.3))
    assert abs(first["share"] - erf(sqrt(2) * 0.02 / w)) < 0.12 and abs(first["share"] + second["share"] - 1) < 1e-6


def test_patterns():
    ring = sensors.spinning([0], 4, begin=0, turn=360).directions[0]
    np.testing.assert_allclose(ring, [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], atol=1e-7)
    np.testing.assert_allclose(sensors.spinning([10, -20], 8).times[1], np.arange(8) / 8)
    corners = sensors.raster(3, 5, horizontal_fov=90, vertical_fov=60).directions
    np.testing.assert_allclose(np.degrees(np.arctan2(corners[0, :, 1], corners[0, :, 0])), [45, 22.5, 0, -22.5, -45], atol=1e-4)
    np.testing.assert_allclose(np.degrees(np.arcsin(corners[:, 0, 2])), [30, 0, -30], atol=1e-4)
    flower = sensors.rosette(20000, fov=40).directions[0].astype(float)
    off = np.degrees(np.arccos(flower[:, 0]))
    assert off.max() < 20.001 and off.max() > 19.9 and off.min() < 0.1
    np.testing.assert_allclose(np.linalg.norm(flower, axis=1), 1, rtol=1e-6)


def test_radar_separates_velocities(room):
    """A box in front of the wall, of one range with it, is another return if it moves."""
    room.move([placed(5.3, 0, 0)], [placed(5.1, 0, 0)])
    radar = sensors.radar(room, beams=1, divergence=(20, 20), range_resolution=1.0, velocity_resolution=0.5)
    found = radar.scan(np.eye(4)).returns[0, 0]
    moving = found[found["instance"] == 1]
    assert len(moving) == 1 and moving["velocity"][0] < -1.8 and (np.abs(found["velocity"][found["instance"] == 0]) < 0.01).all()
    both = sensors.radar(room, beams=1, divergence=(20, 20), range_resolution=1.0, velocity_resolution=5).scan(np.eye(4)).returns[0, 0]
    assert len(both[both["instance"] != claray.MISS]) == len(found[found["instance"] != claray.MISS]) - 1


def test_point_cloud2_has_the_layout_of_ros(room):
    room.move([placed(3, 0, 0)])
    scan = sensors.Sensor(room, sensors.spinning([10, 0, -10], 90), farthest=4.5, duration=0.1).scan(np.eye(4))
    cloud = scan.point_cloud2()
    assert (cloud.height, cloud.point_step, cloud.is_dense, cloud.is_bigendian) == (1, 24, True, False)
    assert cloud.row_step == 24 * cloud.width and cloud.data.dtype == np.uint8 and cloud.data.size == cloud.height * cloud.row_step
    assert [(f.name, f.offset, f.datatype, f.count) for f in cloud.fields] == [
        ("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("intensity", 12, 7, 1), ("ring", 16, 6, 1), ("time", 20, 7, 1)]
    numpy_type = {6: "<u4", 7: "<f4"}  # as sensor_msgs_py.point_cloud2 reads it
    dtype = np.dtype({"names": [f.name for f in cloud.fields], "formats": [numpy_type[f.datatype] for f in cloud.fields],
                      "offsets": [f.offset for f in cloud.fields], "itemsize": cloud.point_step})
    points = np.frombuffer(cloud.data.tobytes(), dtype)
    there = scan.returns[scan.valid]
    assert 0 < len(points) < 270 and len(points) == cloud.width == len(there)
    np.testing.assert_array_equal(np.stack([points["x"], points["y"], points["z"]], 1), there["point"])
    for name in ("intensity", "ring", "time"):
        np.testing.assert_array_equal(points[name], there[name])
    assert points["time"].max() < 0.1 and set(points["ring"]) == {0, 1, 2}
    grid = scan.point_cloud2(("z", "instance"), organized=True)
    assert (grid.height, grid.width, grid.point_step, grid.row_step, grid.is_dense) == (3, 90, 8, 720, False)
    words = grid.data.view([("z", "<f4"), ("instance", "<u4")]).reshape(3, 90)
    assert (np.isnan(words["z"]) == (words["instance"] == claray.MISS)).all() and np.isnan(words["z"]).any()


def test_several_sensors_and_kept_results(room):
    sensor = sensors.Sensor(room, sensors.raster(4, 9), range_noise=0.1, seed=5)
    poses = np.stack([placed(0, 0, 0), placed(-1, 0, 0)])
    first = sensor.scan(poses, number=1)
    again = sensor.scan(poses, number=1)
    other = sensor.scan(poses, number=2)
    assert first.shape == (2, 4, 9, 1)
    assert first.returns.tobytes() == again.returns.tobytes() != other.returns.tobytes()
    out = np.empty(first.shape, sensors.RETURN)
    assert other.read(out) is out and out.tobytes() == other.returns.tobytes()
    errors = first.returns["range"] - sensors.Sensor(room, sensor.pattern).scan(poses).returns["range"]
    assert not np.array_equal(errors[0], errors[1])


_PROGRAM = """
import hashlib, sys, numpy as np, claray
from claray import sensors
scene = claray.load("terrain:20000")
low, high = scene.bounds
extent, up = float((high - low).max()), np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0]])  # z is up, as for lidars
small = 0.1 * up
small[:, 3] = up[:, :3] @ (0.5 * (low + high)) + (0.1 * extent, 0, 0.05 * extent)
turned = small @ np.array([[0.9, 0, 0.3, 0], [0, 1, 0, 0], [-0.3, 0, 0.9, 0], [0.0, 0, 0, 1]])
scene.set_instances([0, 0], [up, small])
world = sensors.World(scene, movers=[1], reflectances=np.linspace(0.2, 0.9, len(scene.materials)))
world.move([small], [turned])
middle = up[:, :3] @ (0.5 * (low + high)) + (0, 0, 0.08 * extent)
pose = sensors.look_at(middle, middle + (1, 0, 0.1))
end = sensors.look_at(middle + (0.1, 0, 0), middle + (1, 0.3, 0.2))
digest = hashlib.sha256()
for options in (dict(rays=1), dict(rays=5, returns=3, divergence=(0.3, 0.1), range_noise=0.02, intensity_noise=0.1, velocity_noise=0.1,
                                   dropout=0.05, extinction=0.001, seed=3), dict(rays=4, returns=2, order="last", frame="world", divergence=1)):
    for pattern in (sensors.spinning(np.linspace(10, -60, 16), 300), sensors.rosette(5000, fov=70)):
        scan = sensors.Sensor(world, pattern, farthest=2 * extent, **options).scan(pose, end, number=4)
        assert {0, 1} <= set(scan.returns['instance'][scan.valid]) and not scan.valid.all(), options
        digest.update(scan.returns.tobytes())
print("hash", digest.hexdigest(), claray.default_device().name)
"""


def _hash(**environment):
    result = subprocess.run([sys.executable, "-c", _PROGRAM], env=os.environ | environment, capture_output=True, text=True, check=True)
    return next(line for line in result.stdout.splitlines() if line.startswith("hash")).split()[1]


def test_bits_are_those_of_a_second_driver():
    vendors = BUILD / "second_driver" / "vendors"
    if not vendors.is_dir():
        pytest.skip("./dev test installs a second driver")
    assert _hash() == _hash(OCL_ICD_VENDORS=str(vendors), CLARAY_DEVICE="")


@pytest.mark.parametrize("words, call", [
    ("elevations: has dtype", lambda w: sensors.spinning("up", 8)),
    ("columns: is 0", lambda w: sensors.spinning([0], 0)),
    ("horizontal_fov: is", lambda w: sensors.raster(2, 2, horizontal_fov=180)),
    ("rows: is 2.5", lambda w: sensors.raster(2.5, 2)),
    ("directions: has dtype float64 and shape (3,)", lambda w: sensors.Pattern([1, 0, 0.0])),
    ("directions: row 0 is", lambda w: sensors.Pattern([[np.nan, 0, 0]])),
    ("times: has dtype float64 and shape (2,)", lambda w: sensors.Pattern([[1, 0, 0]], [0.0, 1.0])),
    ("times: holds numbers outside", lambda w: sensors.Pattern([[1, 0, 0]], 2)),
    ("focal: give either", lambda w: sensors.camera(4, 4)),
    ("distortion: is [1.0", lambda w: sensors.camera(4, 4, focal=3, distortion=[1.0] * 6)),
    ("lens: unknown name 'fish'", lambda w: sensors.camera(4, 4, focal=3, lens="fish")),
    ("shutter: is 2", lambda w: sensors.camera(4, 4, focal=3, shutter=2)),
    ("target: lies at the position", lambda w: sensors.look_at((0, 0, 0), (0, 0, 1))),
    ("scene: is a int", lambda w: sensors.World(3)),
    ("world: is a str", lambda w: sensors.Sensor("town", sensors.raster(2, 2))),
    ("pattern: is a list", lambda w: sensors.Sensor(w, [[1, 0, 0]])),
    ("rays: is 65", lambda w: sensors.Sensor(w, sensors.raster(2, 2), rays=65)),
    ("returns: is 2", lambda w: sensors.Sensor(w, sensors.raster(2, 2), returns=2)),
    ("order: unknown name", lambda w: sensors.Sensor(w, sensors.raster(2, 2), order="best")),
    ("dropout: is -", lambda w: sensors.Sensor(w, sensors.raster(2, 2), dropout=-0.5)),
    ("range_noise: is nan", lambda w: sensors.Sensor(w, sensors.raster(2, 2), range_noise=float("nan"))),
    ("divergence: is (1, 2, 3); use 1 or 2", lambda w: sensors.Sensor(w, sensors.raster(2, 2), divergence=(1, 2, 3))),
    ("divergence: is -1; use degrees", lambda w: sensors.Sensor(w, sensors.raster(2, 2), divergence=-1)),
    ("rays: is 65; use an integer from 1 to 64", lambda w: sensors.Sensor(w, sensors.raster(2, 2), rays=65)),
    ("returns: is 9, and a beam has 1 rays", lambda w: sensors.Sensor(w, sensors.raster(2, 2), returns=9)),
    ("elevations: is empty", lambda w: sensors.spinning([], 8)),
    ("dropout: is 2; use a number from 0 to 1", lambda w: sensors.Sensor(w, sensors.raster(2, 2), dropout=2)),
    ("seed: is -1", lambda w: sensors.Sensor(w, sensors.raster(2, 2), seed=-1)),
    ("transforms: has 2 matrices", lambda w: w.move([placed(1, 0, 0)] * 2)),
    ("ends: has 2 matrices", lambda w: w.move([placed(1, 0, 0)], [placed(1, 0, 0)] * 2)),
    ("pose: has dtype float64 and shape (3, 4)", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(np.eye(4)[:3])),
    ("pose: is not a rotation", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(2 * np.eye(4))),
    ("pose_end: has 2 matrices", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(np.eye(4), [np.eye(4)] * 2)),
    ("pose_end: half a turn", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(np.eye(4), np.diag([-1, -1, 1, 1]))),
    ("number: is -1", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(np.eye(4), number=-1)),
    ("fields: unknown name 'rgb'", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(np.eye(4)).point_cloud2(("x", "rgb"))),
    ("out: is", lambda w: sensors.Sensor(w, sensors.raster(2, 2)).scan(np.eye(4)).read(np.empty(4))),
])
def test_bad_input_names_its_argument(room, words, call):
    with pytest.raises(UsageError) as error:
        call(room)
    assert str(error.value).startswith(words), error.value


def test_bad_reflectances_and_movers_are_named():
    scene = claray.load("cornell")
    for words, options in (("reflectances: has 1 numbers", {"reflectances": [1.0]}), ("reflectances: number 0", {"reflectances": [-1.0] * len(scene.materials)}),
                           ("movers: holds 99", {"movers": [99]}), ("movers: has dtype", {"movers": [0.5]}), ("builder: ", {"builder": "best"})):
        with pytest.raises(UsageError) as error:
            sensors.World(scene, **options)
        assert str(error.value).startswith(words), error.value
