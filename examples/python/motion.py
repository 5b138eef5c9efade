# %% [markdown]
# # Motion blur
# Vanes of a wheel at the same instant and during an exposure. Each instance has a transform at the begin and at the end.
#
#     python examples/python/motion.py [-o motion.png] [--spp 64] [--width 400]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--width", type=int, default=400)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own


# %%
def turned(angle: float, x: float) -> list[list[float]]:
    """A matrix that turns about z and moves along x."""
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return [[c, -s, 0, x], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


scene = claray.Scene()
colours = [(0.8, 0.2, 0.15), (0.9, 0.7, 0.2), (0.2, 0.45, 0.8)]
vanes = [scene.add_mesh([[0.15, -0.12, 0], [1, -0.3, 0], [1, 0.3, 0], [0.15, 0.12, 0]], [[0, 1, 2], [0, 2, 3]],
                        material=scene.add_material(albedo=colour)) for colour in colours]
floor = scene.add_mesh([[-4, -2, -0.4], [4, -2, -0.4], [4, 2, -0.4], [-4, 2, -0.4]], [[0, 1, 2], [0, 2, 3]],
                       material=scene.add_material(albedo=(0.8, 0.8, 0.8)))
scene.add_instance(floor)
for k in range(6):
    angle = k * np.pi / 3
    scene.add_instance(vanes[k % 3], turned(angle, -1.2))
    scene.add_instance(vanes[k % 3], turned(angle, 1.2), turned(angle + 0.3, 1.2))
scene.sky = 0.2, 0.22, 0.25
scene.add_light(kind="sun", direction=(0.5, -0.4, -1), intensity=(1.2, 1.15, 1.05), outer_angle=0.02)
scene.camera = claray.Camera(position=(0, 0, 7), target=(0, 0, 0), vertical_fov=22)
image = claray.render(scene, width=options.width, height=options.width // 2, spp=options.spp)
moving = int((scene.instances["ends"] != scene.instances["transforms"]).any(axis=(1, 2)).sum())
print(f"{moving} of {len(scene.instances['meshes'])} instances move")
image

# %%
if options.output:
    image.save(options.output)
