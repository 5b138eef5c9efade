# %% [markdown]
# # Lidar
# A lidar turns over a terrain: the distance of each pulse as a picture, and the cloud of points.
#
#     python examples/python/lidar.py [--scene SCENE] [-o lidar.png] [--points points.ply] [--steps 1024]
#
# The cells run in a notebook, too: editors and jupytext open this file as one.

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("--scene", default="terrain:200000")
parser.add_argument("-o", "--output")
parser.add_argument("--points", help="a file for the cloud of points (.ply)")
parser.add_argument("--steps", type=int, default=1024, help="pulses of a turn")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# The sensor is a hundredth of the scene's extent above the ground, in the middle. It has 64 channels from 25 degrees below the horizon to 15 above (y is up).

# %%
scene = claray.load(options.scene)
bvh = claray.Bvh(scene)
low, high = scene.bounds
extent = float((high - low).max())
above = 0.5 * (low + high) + [0, high[1] - low[1], 0]
sensor = above - [0, claray.closest_hit(bvh, above[None], (0, -1, 0))["t"][0] - 0.01 * extent, 0]
elevation = np.radians(np.linspace(15, -25, 64))[:, None]
azimuth = np.linspace(0, 2 * np.pi, options.steps, endpoint=False)
directions = np.stack(np.broadcast_arrays(np.cos(elevation) * np.cos(azimuth), np.sin(elevation),
                                          np.cos(elevation) * np.sin(azimuth)), axis=-1).reshape(-1, 3)

# %% [markdown]
# One query for all pulses. `t` is the distance, because the directions have unit length.

# %%
reach = 0.5 * extent
hits = claray.closest_hit(bvh, sensor, directions, tmax=reach)
returned = hits["primitive"] != claray.MISS
points = sensor + hits["t"][returned, None] * directions[returned]
print(f"{len(points)} of {len(directions)} pulses return, the nearest from {hits['t'].min():.3g}")

# %% [markdown]
# A row for each channel, four pixels high; near is bright (by the logarithm), and pulses that do not return are dark blue.

# %%
far = np.log(hits["t"] / hits["t"].min()) / np.log(reach / hits["t"].min())
colours = np.where(returned[:, None], (1 - 0.95 * far[:, None]) * [1.0, 0.8, 0.5], [0.0, 0.01, 0.05])
picture = np.repeat(colours.reshape(64, options.steps, 3), 4, axis=0).astype(np.float32).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
if options.points:
    with open(options.points, "w") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n")
        file.write("property float x\nproperty float y\nproperty float z\nend_header\n")
        np.savetxt(file, points, "%.6g")
