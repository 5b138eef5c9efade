"""A lidar that turns over a terrain: a cloud of points, with the share of pulses that return.

    python examples/python/lidar.py [SCENE] [-o points.ply]
"""

import argparse

import numpy as np

import claray


def pulses(channels=64, steps=2048, lowest=-25.0, highest=15.0):
    """Directions of one turn: (channels * steps, 3), unit length, z up."""
    elevation = np.radians(np.linspace(lowest, highest, channels))
    azimuth = np.linspace(0, 2 * np.pi, steps, endpoint=False)
    e, a = np.meshgrid(elevation, azimuth, indexing="ij")
    return np.stack([np.cos(e) * np.cos(a), np.sin(e), np.cos(e) * np.sin(a)], axis=-1).reshape(-1, 3)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", nargs="?", default="terrain:200000")
    parser.add_argument("-o", "--output")
    options = parser.parse_args()
    scene = claray.load(options.scene)
    bvh = claray.Bvh(scene)
    low, high = scene.bounds
    sensor = 0.5 * (low + high) + [0, 0.6 * (high - low)[1], 0]
    directions = pulses()
    reach = 0.5 * float((high - low).max())
    hits = claray.closest_hit(bvh, sensor, directions, tmax=reach)
    returned = hits["primitive"] != claray.MISS
    points = sensor + hits["t"][returned, None] * directions[returned]
    print(f"{len(points)} of {len(directions)} pulses return, the nearest from {hits['t'].min():.3g}")
    if options.output:
        with open(options.output, "w") as file:
            file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n")
            file.write("property float x\nproperty float y\nproperty float z\nend_header\n")
            np.savetxt(file, points, "%.6g")


if __name__ == "__main__":
    main()
