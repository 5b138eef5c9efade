# %% [markdown]
# # X-ray
# The length of each ray inside of a closed surface, by all hits along it: an X-ray picture by Beer's law.
#
#     python examples/python/xray.py [--scene SCENE] [-o xray.png] [--side 300]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("--scene", default="ball:20000", help="of closed surfaces")
parser.add_argument("-o", "--output")
parser.add_argument("--side", type=int, default=300, help="pixels along each side of the picture")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# A hollow ball within a ball is an object with a wall. Parallel rays come from the front.

# %%
vertices, triangles = claray.load(options.scene).meshes[0]["vertices"], claray.load(options.scene).meshes[0]["triangles"]
middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
inner = middle + 0.7 * (vertices - middle) + [0.1, 0.1, 0]
bvh = claray.Bvh(np.concatenate([vertices, inner]), np.concatenate([triangles, triangles + len(vertices)]))
extent = float(np.ptp(vertices, axis=0).max())
y, x = np.mgrid[0.55 : -0.55 : options.side * 1j, -0.55 : 0.55 : options.side * 1j] * extent
origins = np.stack([middle[0] + x, middle[1] + y, np.full_like(x, vertices[:, 2].max() + extent)], axis=-1)
hits = claray.all_hits(bvh, origins, (0, 0, -1))

# %% [markdown]
# Along a ray, the hits go in and out by turns. The signs of a sum of their distances are those of their places in the list.

# %%
place = np.arange(len(hits.elements)) - hits.offsets[:-1].astype(np.int64)[hits.queries]
signed = np.where(place % 2 == 0, -1, 1) * hits.elements["t"].astype(np.float64)
length = np.bincount(hits.queries, weights=signed, minlength=len(hits)).reshape(options.side, options.side)
print(f"{len(hits.elements)} hits, the longest way inside is {length.max() / extent:.3f} of the extent")
picture = np.repeat(1 - np.exp(-3 * length[..., None] / extent), 3, axis=2).astype(np.float32).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
