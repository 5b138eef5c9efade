# %% [markdown]
# # Sky view factor
# The share of the sky that each place of a surface sees, weighted by the cosine: a measure of city climate.
#
#     python examples/python/sky_view_factor.py [--scene SCENE] [-o factor.png] [--side 200]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("--scene", default="terrain:200000")
parser.add_argument("-o", "--output")
parser.add_argument("--side", type=int, default=200, help="places along each side of the map")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# Rays from above find the places on the surface (y is up), which are then lifted a little.

# %%
scene = claray.load(options.scene)
bvh = claray.Bvh(scene)
low, high = scene.bounds
side: int = options.side
x, z = (np.linspace(float(low[k]), float(high[k]), side) for k in (0, 2))
above = np.stack(np.broadcast_arrays(x, high[1] + 1, z[:, None]), axis=-1).reshape(-1, 3)
down = claray.closest_hit(bvh, above, (0, -1, 0), coherence="coherent")
on_surface = down["primitive"] != claray.MISS
places = above[on_surface] - (down["t"][on_surface, None] - 1e-4 * float((high - low).max())) * [0, 1, 0]

# %% [markdown]
# Directions over the horizontal plane with density cosine / pi, evenly spread (Vogel's spiral): the mean of what they see is
# the factor. One query for each direction lets neighbours run side by side.

# %%
i = np.arange(64) + 0.5
radius, angle = np.sqrt(i / len(i)), np.pi * (3 - np.sqrt(5)) * i
directions = np.stack([radius * np.cos(angle), np.sqrt(1 - radius**2), radius * np.sin(angle)], axis=-1)
free = np.zeros(len(places))
for direction in directions:
    free += ~claray.any_hit(bvh, places, direction, coherence="coherent")
factor = free / len(directions)
print(f"sky view factor: least {factor.min():.2f}, mean {factor.mean():.2f}, largest {factor.max():.2f}")

# %%
pixels = np.zeros((len(above), 3), np.float32)
pixels[on_surface] = factor[:, None]
picture = pixels.reshape(options.side, options.side, 3).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
