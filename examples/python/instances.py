# %% [markdown]
# # A forest of instances
# A tree of 2,000 leaves, 4,000 times: one structure in memory. Rays find which tree and which leaf they hit.
#
#     python examples/python/instances.py [-o instances.png] [--trees 4000] [--side 400]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--trees", type=int, default=4000)
parser.add_argument("--side", type=int, default=400, help="pixels along each side of the picture")
options = parser.parse_known_args()[0]  # a notebook has arguments of its own
rng = np.random.default_rng(3)

# %% [markdown]
# The leaves are triangles around a ball on a stem, 1 high.

# %%
middles = rng.normal(size=(2000, 1, 3))
middles *= 0.3 * rng.uniform(0.6, 1, (2000, 1, 1)) / np.linalg.norm(middles, axis=2, keepdims=True)
leaves = middles + rng.normal(0, 0.03, (2000, 3, 3)) + [0, 0.7, 0]
tree = claray.Bvh(leaves.reshape(-1, 3), np.arange(6000).reshape(-1, 3))

# %% [markdown]
# Each tree has a place, a size and a turn about y.

# %%
trees: int = options.trees
size, turn = rng.uniform(0.6, 1.4, trees), rng.uniform(0, 2 * np.pi, trees)
transforms = np.zeros((trees, 3, 4))
transforms[:, 0, 0] = transforms[:, 2, 2] = size * np.cos(turn)
transforms[:, 0, 2], transforms[:, 2, 0] = size * np.sin(turn), -size * np.sin(turn)
transforms[:, 1, 1] = size
transforms[:, [0, 2], 3] = rng.uniform(-20, 20, (trees, 2))
forest = claray.InstancedBvh(tree, transforms)
statistics = forest.statistics()
print(f"{statistics['instances']} trees, {statistics['instances'] * 2000:,} triangles in {(statistics['top_bytes'] + statistics['bottom_bytes']) / 1e6:.1f} MB")

# %% [markdown]
# A view from the edge of the forest. The colour is that of the tree; near is bright. What is below the horizon and no tree is soil.

# %%
y, x = np.mgrid[-1 : 1 : options.side * 1j, -1 : 1 : options.side * 1j]
directions = np.stack([0.6 * x, -0.6 * y - 0.35, -np.ones_like(x)], axis=-1)
hits = claray.closest_hit(forest, (0, 6, 24), directions)
found = hits["primitive"] != claray.MISS
print(f"{found.mean():.0%} of the rays hit {len(np.unique(hits['instance'][found]))} trees")
tints = np.array([0.15, 0.5, 0.1]) * rng.uniform(0.4, 1.6, (trees, 3))
colours = np.where(found[..., None], tints[np.where(found, hits["instance"], 0)] * (12 / (1 + hits["t"]))[..., None],
                   np.where(directions[..., 1:2] < 0, [0.1, 0.07, 0.04], [0.5, 0.7, 1.0]))
picture = np.nan_to_num(colours).astype(np.float32).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
