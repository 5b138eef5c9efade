# %% [markdown]
# # A lidar in a town
# A car with a lidar, a radar and a camera drives through a town of a million triangles, among other cars and people.
#
#     python examples/python/town_lidar.py [-o town_lidar.png] [--blocks 6] [--channels 128] [--columns 1800] [--scans 3]
#
# The cells run in a notebook, too: editors and jupytext open this file as one.

# %%
import argparse

import numpy as np
from numpy.typing import NDArray
from models.town import MATERIALS, NUMBER, PITCH, REFLECTANCE, STREET, Town

import claray
from claray import sensors

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--blocks", type=int, default=6, help="of the town, along each side")
parser.add_argument("--channels", type=int, default=128)
parser.add_argument("--columns", type=int, default=1800)
parser.add_argument("--scans", type=int, default=3)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# Houses and trees stay where they are; cars and people are instances that may move.

# %%
town = Town(options.blocks)
world = sensors.World(town.scene(), movers=town.movers, reflectances=REFLECTANCE)
print(f"{world.triangle_count} triangles, {len(world.movers)} cars and people")

# %% [markdown]
# Three sensors. Each beam of the lidar has five rays, so that edges give two or three returns; ranges have an error of 2 cm.

# %%
lidar = sensors.Sensor(world, sensors.spinning(np.linspace(15, -25, options.channels), options.columns), rays=5, returns=3, order="first",
                       divergence=0.17, farthest=120, range_resolution=0.3, range_noise=0.02, intensity_noise=0.05, dropout=0.01,
                       reference_range=10, frame="world")
radar = sensors.radar(world, beams=60, farthest=120, velocity_noise=0.05)
width, height = 600, 338
eye = sensors.camera(width, height, vertical_fov=58, shutter=0.5)
camera = sensors.Sensor(world, eye, farthest=1000)

# %% [markdown]
# The car drives along a street at 10 m/s. Everything moves while the lidar turns once, in a tenth of a second.

# %%
duration = 0.1


def car_at(seconds: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    here = np.array([options.blocks // 2 * PITCH - STREET / 2 + 2.6, 0.36 * town.extent + 10 * seconds, 1.9])
    return sensors.look_at(here, here + (0, 1, 0)), sensors.look_at(here, here + (0, 1, 0), optical=True)


def turn(number: int) -> sensors.Scan:
    now, then = duration * number, duration * (number + 1)
    world.move(*town.motion(now, duration))
    return lidar.scan(car_at(now)[0], car_at(then)[0], number=number)


last = options.scans - 1
for number in range(last):
    turn(number)
scan = turn(last)
now, then = duration * last, duration * (last + 1)
returns = scan.returns[scan.valid]
echoes = radar.scan(car_at(now)[0], car_at(then)[0]).returns
moving = np.isin(returns["instance"], town.movers)
print(f"the last scan: {len(returns)} returns, {(scan.valid.sum(-1) > 1).mean():.1%} of the beams have several; "
      f"{len(np.unique(returns['instance'][moving]))} movers are seen, {returns['velocity'][moving].min():.1f} to {returns['velocity'][moving].max():.1f} m/s")
cloud = scan.point_cloud2()
print(f"PointCloud2: {cloud.width} points of {cloud.point_step} bytes, {', '.join(field.name for field in cloud.fields)}")
seen = echoes[echoes["instance"] != claray.MISS]
print(f"radar: {len(seen)} returns, those of movers at {np.unique(np.round(seen['range'][seen['instance'] > 0])).astype(int).tolist()} m")

# %% [markdown]
# Above: the town, as the camera sees materials, from behind and above the car. Below: the points of the lidar from there, bright where
# the intensity is large; cars and people are red as they approach and blue as they depart.

# %%
behind = car_at(now)[0][:3, 3] + (0, -14, 10)
view = sensors.look_at(behind, behind + (0, 1, -0.45), optical=True)
image = camera.scan(view).returns[..., 0]
there = image["instance"] != claray.MISS
colours = np.array([color for _, color, _ in MATERIALS] + [(0.55, 0.7, 0.95)])
shade = 0.35 + 0.65 * np.abs(image["normal"] @ np.array([0.5, 0.6, -0.62]))
shown = np.where(there[..., None], shade[..., None] * colours[np.where(there, image["material"], len(MATERIALS))], colours[-1])

dots = np.zeros((height, width, 3))
at = (scan.points - view[:3, 3]) @ view[:3, :3]
ahead = at[:, 2] > 0.5
focal = height / 2 / np.tan(np.radians(29))
pixels: NDArray[np.float64] = focal * at[ahead, :2] / at[ahead, 2:] + [width / 2 - 0.5, height / 2 - 0.5]
x, y = np.round(pixels).astype(int).T
inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
kept = returns[ahead][inside]
bright = np.clip(0.15 + 0.5 * np.sqrt(kept["intensity"] * (kept["range"] / 10) ** 2), 0, 1)
tint = np.where(np.isin(kept["instance"], town.movers)[:, None], np.where(kept["velocity"][:, None] < 0, [1, 0.25, 0.2], [0.3, 0.55, 1]),
                np.where(kept["material"][:, None] == NUMBER["leaves"], [0.5, 0.9, 0.4], [1, 0.85, 0.6]))
np.maximum.at(dots, (y[inside], x[inside]), bright[:, None] * tint)
picture = np.concatenate([shown, dots]).astype(np.float32).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
