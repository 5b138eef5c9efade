# %% [markdown]
# # A light map
# The light on the floor of a room is baked into a texture, once; images then read it.
#
#     python examples/python/light_map.py [-o light_map.png] [--texels 96] [--spp 64] [--width 300]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--texels", type=int, default=96, help="along each side of the map")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--width", type=int, default=300)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %% [markdown]
# The floor needs coordinates that map it to 0..1 without overlaps.

# %%
scene = claray.Scene()
wood = scene.add_material(albedo=(0.7, 0.6, 0.5))
floor = scene.add_mesh([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]], [[0, 2, 1], [0, 3, 2]], material=wood,
                       uvs1=[[0, 0], [1, 0], [1, 1], [0, 1]])
box = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (0, 1) for z in (-0.5, 0.5)])
sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
faces = [[side[0], side[i], side[i + 1]] for side in sides for i in (1, 2)]
scene.add_mesh(box, faces, material=scene.add_material(albedo=(0.8, 0.3, 0.2)))
scene.add_mesh([[-1.5, 2, -1], [-0.5, 2, -1], [-0.5, 2, 0], [-1.5, 2, 0]], [[0, 1, 2], [0, 2, 3]],
               material=scene.add_material(albedo=(0, 0, 0), emission=(24, 22, 18)))
scene.sky = 0.05, 0.06, 0.08
scene.camera = claray.Camera(position=(2.5, 3, 5), target=(0, 0.2, 0), vertical_fov=38)

# %%
light = claray.bake_light_map(scene, floor, width=options.texels, height=options.texels, spp=4 * options.spp)
print(f"irradiance of the floor: {light.pixels.min():.2f} to {light.pixels.max():.2f} W / m^2")
scene.use_light_map(floor, light)
image = claray.render(scene, width=options.width, height=options.width * 2 // 3, spp=options.spp)
image

# %%
if options.output:
    image.save(options.output)
