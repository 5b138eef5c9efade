"""How often sensors scan a town of a million triangles in which cars and people move, and the sensor, too.

    python bench/python/sensors.py [--device cpu] [--sensors 1] [--rays 3] [--returns 3] [--channels 128] [--columns 1800] [--scans 20]

Each scan moves everything, traces, and, with --read, copies all returns to the host. Hz is of the median scan. "processor" is the time of all
threads of this process. "hash" is that of the returns of scan 3: equal bits on every device have one hash.
"""

from __future__ import annotations

import argparse
import hashlib
import pathlib
import sys
import time

import numpy as np

import claray
from claray import sensors

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"))
from models.town import PITCH, REFLECTANCE, STREET, Town  # noqa: E402


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    parser.add_argument("--device", default=None)
    parser.add_argument("--sensors", type=int, default=1)
    parser.add_argument("--rays", type=int, default=3, help="of a beam")
    parser.add_argument("--returns", type=int, default=3, help="most of a beam")
    parser.add_argument("--channels", type=int, default=128)
    parser.add_argument("--columns", type=int, default=1800)
    parser.add_argument("--scans", type=int, default=20)
    parser.add_argument("--builder", default="automatic")
    parser.add_argument("--read", action="store_true", help="copy all returns to the host")
    return parser.parse_args()


def poses_at(seconds: float, count: int) -> np.ndarray:
    """(count, 4, 4): cars on parallel lanes and places, which drive along y at 10 m/s."""
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :2, :2] = [[0, -1], [1, 0]]
    number = np.arange(count)
    poses[:, 0, 3] = (number % 6 + 1) * PITCH - STREET / 2 + 2.6
    poses[:, 1, 3] = 20 + 17.0 * (number // 6) + 10 * seconds
    poses[:, 2, 3] = 1.9
    return poses


def main() -> None:
    options = parse()
    town = Town()
    scene = town.scene()
    device = claray.Device(options.device) if options.device is not None else claray.default_device()
    begin = time.perf_counter()
    world = sensors.World(scene, movers=town.movers, reflectances=REFLECTANCE, device=device, builder=options.builder)
    print(f"{world}: built in {time.perf_counter() - begin:.2f} s")
    duration = 0.1
    lidar = sensors.Sensor(world, sensors.spinning(np.linspace(15, -25, options.channels), options.columns), rays=options.rays,
                           returns=options.returns, divergence=0.17, farthest=200, range_resolution=0.3, range_noise=0.02,
                           intensity_noise=0.05, dropout=0.01, duration=duration)
    out = np.empty((options.sensors, options.channels, options.columns, options.returns), sensors.RETURN) if options.read else None

    def scan(number: int) -> sensors.Scan:
        world.move(*town.motion(duration * number, duration))
        done = lidar.scan(poses_at(duration * number, options.sensors), poses_at(duration * (number + 1), options.sensors), number=number)
        if out is not None:
            done.read(out)
        device.finish()
        return done

    found = scan(3)  # compiles, too
    digest = hashlib.sha256()
    returns = found.returns
    digest.update(returns.data)
    print(f"hash {digest.hexdigest()[:32]}; returns per beam {(returns['instance'] != claray.MISS).sum() / returns[..., 0].size:.3f}, "
          f"of movers {np.isin(returns['instance'], town.movers).sum()}")
    del found, returns
    walls, processor = [], time.process_time()
    for number in range(options.scans):
        begin = time.perf_counter()
        scan(number)
        walls.append(time.perf_counter() - begin)
    processor = (time.process_time() - processor) / options.scans
    rays = options.sensors * options.channels * options.columns * options.rays
    print(f"{options.sensors} x {options.channels} x {options.columns} beams of {options.rays} rays, {options.returns} returns, on {device.name}: "
          f"median {1e3 * np.median(walls):.2f} ms, {1 / np.median(walls):.1f} Hz, best {1 / min(walls):.1f} Hz; processor {1e3 * processor:.1f} ms a scan; "
          f"{rays / np.median(walls) / 1e6:.1f} M rays/s")


if __name__ == "__main__":
    main()
