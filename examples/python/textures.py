# %% [markdown]
# # Textures
# A wall of bricks: colours, heights and roughness are arrays that NumPy makes. The heights become normals.
#
#     python examples/python/textures.py [-o textures.png] [--spp 64] [--width 360]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--width", type=int, default=360)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# Bricks of 4 x 8, every other row shifted by half a brick. Values at the edges fall to the mortar.

# %%
side, rows, columns = 512, 8, 4
rng = np.random.default_rng(1)
v, u = np.mgrid[0:side, 0:side] / side
row = (v * rows).astype(int)
along = (u * columns + 0.5 * (row % 2)) % columns
inside = np.minimum.reduce([along % 1 * columns, (1 - along % 1) * columns, v * rows % 1 * 2, (1 - v * rows % 1) * 2])
brick = np.clip(inside / 0.25, 0, 1)
tone = rng.uniform(0.7, 1.1, (rows, columns))[row, along.astype(int)]
grain = rng.normal(0, 0.03, (side, side))
colours = np.where((brick > 0.5)[..., None], (tone + grain)[..., None] * [0.45, 0.16, 0.1], 0.5 + grain[..., None])
heights = (brick + grain).astype(np.float32)
roughness = np.zeros((side, side, 3), np.float32)
roughness[..., 1] = np.where(brick > 0.5, 0.4, 1)  # green is the roughness (glTF)

# %%
scene = claray.Scene()
wall = scene.add_material(
    kind="principled", albedo=(1, 1, 1), roughness=1,
    albedo_map=scene.add_texture(colours.astype(np.float32)),
    normal_map=scene.add_texture(claray.Texture(heights).normal_map(6)),
    metallic_roughness_map=scene.add_texture(roughness))
scene.add_mesh([[-1.5, -1, 0], [1.5, -1, 0], [1.5, 1, 0], [-1.5, 1, 0]], [[0, 1, 2], [0, 2, 3]],
               uvs=[[0.0, 1.0], [1.5, 1.0], [1.5, 0.0], [0.0, 0.0]], material=wall)
scene.sky = 0.3, 0.35, 0.4
scene.add_light(kind="sun", direction=(1, -0.7, -0.6), intensity=(4, 3.6, 3), outer_angle=0.01)
scene.camera = claray.Camera(position=(0.9, 0.3, 2.2), target=(0, 0, 0), vertical_fov=42)
image = claray.render(scene, width=options.width, height=options.width * 2 // 3, spp=options.spp)
print(f"{len(scene.textures)} textures; the scene uses {', '.join(scene.effects())}")
image

# %%
if options.output:
    image.save(options.output)
