# %% [markdown]
# # A map in metres
# Coordinates of a map are large, and float32 rounds them by up to half a metre. A structure with an origin resolves micrometres.
#
#     python examples/python/far_map.py [-o far_map.png] [--side 300]

# %%
import argparse
import warnings

import numpy as np
from numpy.typing import NDArray

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--side", type=int, default=300, help="pixels along each side of the picture")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# A terrain of 200 m at a place with large coordinates.

# %%
corner = np.array([4_500_000.0, 0.0, 5_400_000.0])
x, z = np.meshgrid(np.linspace(0, 200, 401), np.linspace(0, 200, 401))
height = 8 * np.sin(x / 20) * np.cos(z / 30) + 2 * np.sin(x / 3) * np.sin(z / 4)
vertices = np.stack([x, height, z], axis=-1).reshape(-1, 3) + corner
first = (np.arange(400)[:, None] * 401 + np.arange(400)).reshape(-1, 1)
triangles = np.concatenate([first + [0, 401, 1], first + [1, 401, 402]])
near = claray.Bvh(vertices, triangles, origin="auto")
with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it warns of the rounding
    rounded = claray.Bvh(vertices, triangles)

# %% [markdown]
# Rays from 50 m above the middles of some triangles find the ground. The picture shows the error of their distances, by the logarithm: with an
# origin on the left, without on the right.

# %%
chosen = np.linspace(0, 399, options.side).astype(int)
grid = vertices.reshape(401, 401, 3)
ground = (grid[np.ix_(chosen, chosen)] + grid[np.ix_(chosen + 1, chosen)] + grid[np.ix_(chosen, chosen + 1)]) / 3
errors: list[NDArray[np.float64]] = []
for name, bvh in (("with an origin", near), ("without", rounded)):
    errors.append(np.abs(claray.closest_hit(bvh, ground + [0, 50, 0], (0, -1, 0))["t"] - 50))
    print(f"{name}: the median error is {np.median(errors[-1]) * 1000:.3f} mm, the largest {errors[-1].max() * 1000:.3f} mm")
picture = claray.false_color(np.log10(np.maximum(np.hstack(errors), 1e-6)))
picture

# %%
if options.output:
    picture.save(options.output)
