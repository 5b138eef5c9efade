# %% [markdown]
# # Render
# Balls of glass and metal on a checked floor, put together from arrays, rendered and denoised.
#
#     python examples/python/render.py [-o ball.png] [--spp 64] [--width 480]

# %%
import argparse

import numpy as np
from numpy.typing import NDArray

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--width", type=int, default=480)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own
scene = claray.Scene()

# %% [markdown]
# The floor: 64 tiles of two materials by turns. Each tile is two triangles.

# %%
side, tile = 8, 0.5
for parity, colour in enumerate([(0.8, 0.8, 0.75), (0.15, 0.25, 0.35)]):
    corners = [(x, z) for x in range(side) for z in range(side) if (x + z) % 2 == parity]
    quads = np.array([[(x, 0, z), (x, 0, z + 1), (x + 1, 0, z + 1), (x + 1, 0, z)] for x, z in corners], float)
    first = 4 * np.arange(len(quads))[:, None]
    scene.add_mesh((quads.reshape(-1, 3) - [side / 2, 0, side / 2]) * tile,
                   np.concatenate([first + [0, 1, 2], first + [0, 2, 3]]), material=scene.add_material(albedo=colour))

# %% [markdown]
# The balls: spheres of rows and columns, with smooth normals.


# %%
def add_ball(centre: NDArray[np.float64], radius: float, material: int, rows: int = 64) -> None:
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    normals = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1).reshape(-1, 3)
    row, column = np.meshgrid(np.arange(rows), np.arange(2 * rows), indexing="ij")
    a = (row * (2 * rows + 1) + column).reshape(-1, 1)
    below = a + 2 * rows + 1
    triangles = np.concatenate([np.hstack([a, below, below + 1]), np.hstack([a, below + 1, a + 1])])
    scene.add_mesh(centre + radius * normals, triangles, normals=normals, material=material)


add_ball(np.array([-0.55, 0.5, 0]), 0.5, scene.add_material(kind="glass", albedo=(1, 1, 1), ior=1.5, roughness=0))
add_ball(np.array([0.6, 0.35, 0.3]), 0.35, scene.add_material(kind="metal", albedo=(0.9, 0.6, 0.3), roughness=0.2))

# %% [markdown]
# A sky, a far light and a camera. The image is an array of linear radiance.

# %%
scene.sky = (0.9, 0.9, 1.0), (0.4, 0.6, 1.0)
scene.add_light(kind="directional", direction=(-1, -1.5, -1), intensity=(2, 1.9, 1.7))
scene.camera = claray.Camera(position=(0.5, 1.4, 3.2), target=(0, 0.35, 0), vertical_fov=35)
renderer = claray.Renderer(scene, width=options.width, height=options.width * 2 // 3, spp=options.spp)
print(renderer.render())
image = renderer.image(denoise="claray")
image

# %%
if options.output:
    image.save(options.output)
