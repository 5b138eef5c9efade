# %% [markdown]
# # Distances
# How far each place of a plane is from a closed surface, inside and outside: a map with lines of equal distance. Such
# distances make offsets, fillets and collision tests.
#
#     python examples/python/distances.py [--scene SCENE] [-o distances.png] [--side 400]

# %%
import argparse

import numpy as np
from numpy.typing import NDArray

import claray

parser = argparse.ArgumentParser()
parser.add_argument("--scene", help="a closed surface, instead of two rings")
parser.add_argument("-o", "--output")
parser.add_argument("--side", type=int, default=400, help="places along each side of the map")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# The surface is that of two rings, each a grid that is closed in both directions.


# %%
def ring(axis: int, centre: tuple[float, float, float], rows: int = 64) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A torus of radii 1 and 0.3 whose hole is along an axis: vertices and triangles."""
    row, column = (index.ravel() for index in np.indices((rows, rows)))
    u, v = 2 * np.pi * row / rows, 2 * np.pi * column / rows
    vertices = np.stack([(1 + 0.3 * np.cos(v)) * np.cos(u), (1 + 0.3 * np.cos(v)) * np.sin(u), 0.3 * np.sin(v)], axis=-1)
    corner = [(row + i) % rows * rows + (column + j) % rows for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    triangles = np.stack([[corner[k] for k in half] for half in ((0, 1, 2), (0, 2, 3))], axis=-1).transpose(1, 2, 0).reshape(-1, 3)
    return np.roll(vertices, axis + 1, axis=1) + centre, triangles


if options.scene:
    scene = claray.load(options.scene)
else:
    scene = claray.Scene()
    for axis, centre in ((2, (-0.5, 0, 0.1)), (1, (0.5, 0.1, 0))):
        scene.add_mesh(*ring(axis, centre))
bvh = claray.Bvh(scene)

# %% [markdown]
# Signed distances of all places of a plane through the middle, in one query.

# %%
low, high = scene.bounds
middle, reach = 0.5 * (low + high), 0.6 * float((high - low).max())
steps = np.linspace(-reach, reach, options.side)
places = np.stack(np.broadcast_arrays(middle[0] + steps, middle[1] - steps[:, None], middle[2]), axis=-1).reshape(-1, 3)
distance = claray.signed_distance(bvh, places)
print(f"{(distance < 0).mean():.1%} of the plane is inside; the deepest place is {-distance.min():.3g} below the surface")

# %% [markdown]
# Blue is outside and orange inside; a line at each twentieth of the largest extent.

# %%
bands = np.abs(distance) / (float((high - low).max()) / 20)
shade = (0.35 + 0.65 * np.exp(-0.2 * bands)) * np.clip(np.abs(bands - np.round(bands)) * 12, 0.3, 1)
colours = np.where((distance < 0)[:, None], [1.0, 0.5, 0.1], [0.15, 0.4, 1.0]) * shade[:, None]
picture = colours.reshape(options.side, options.side, 3).astype(np.float32).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
