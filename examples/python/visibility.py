# %% [markdown]
# # Visibility
# Which places of a terrain are seen from a tower, by the tower's height: shares, and a map.
#
#     python examples/python/visibility.py [--scene SCENE] [-o visible.png] [--side 300]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("--scene", default="terrain:200000")
parser.add_argument("-o", "--output")
parser.add_argument("--side", type=int, default=300, help="places along each side of the map")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# Rays from above find the places on the ground (y is up).

# %%
scene = claray.load(options.scene)
bvh = claray.Bvh(scene)
low, high = scene.bounds
side: int = options.side
x, z = (np.linspace(float(low[k]), float(high[k]), side + 2)[1:-1] for k in (0, 2))
above = np.stack(np.broadcast_arrays(x, high[1] + 1, z[:, None]), axis=-1).reshape(-1, 3)
ground = claray.closest_hit(bvh, above, (0, -1, 0), coherence="coherent")
on_ground = ground["primitive"] != claray.MISS
places = above[on_ground] - ground["t"][on_ground, None] * [0, 1, 0]

# %% [markdown]
# `unoccluded` tests the segments between the tower's top and the eyes at all places, a thousandth of the extent above the ground.

# %%
middle = places[np.abs(places[:, [0, 2]] - 0.5 * (low + high)[[0, 2]]).sum(axis=1).argmin()]
lowest = np.full(len(places), 3)  # the lowest of the towers that sees a place; 3: none does
for index, height in enumerate((0.01, 0.05, 0.2)):
    tower = middle + [0, height * (high - low)[1], 0]
    seen = claray.unoccluded(bvh, tower, places + [0, 1e-3 * float((high - low).max()), 0])
    lowest[seen] = np.minimum(lowest[seen], index)
    print(f"a tower of {height:4.0%} of the relief sees {seen.mean():6.1%} of {len(places)} places")

# %% [markdown]
# The map: yellow is seen from the lowest tower, orange and red only from higher ones, and grey from none; high ground is bright.

# %%
relief = (places[:, 1] - low[1]) / (high - low)[1]
tints = np.array([[1.0, 0.9, 0.3], [1.0, 0.5, 0.15], [0.8, 0.15, 0.1], [0.3, 0.3, 0.3]])
pixels = np.zeros((len(above), 3), np.float32)
pixels[on_ground] = tints[lowest] * (0.2 + 0.8 * relief[:, None])
picture = pixels.reshape(options.side, options.side, 3).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
