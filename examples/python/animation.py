# %% [markdown]
# # A live scene
# Balls come, fall and go. The renderer follows by `update`, which keeps kernels and meshes where it can.
#
#     python examples/python/animation.py [-o animation.png] [--spp 16] [--width 160]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("-o", "--output")
parser.add_argument("--spp", type=int, default=16)
parser.add_argument("--width", type=int, default=160)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %%
scene = claray.Scene()
ball, floor = claray.load("ball:2000").meshes[0], [[-3, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]]
red, grey = scene.add_material(albedo=(0.8, 0.25, 0.15)), scene.add_material(albedo=(0.6, 0.6, 0.6))
centre = 0.5 * (ball["vertices"].min(axis=0) + ball["vertices"].max(axis=0))
radius = 0.5 * float(np.ptp(ball["vertices"][:, 1]))
unit = scene.add_mesh((ball["vertices"] - centre) / radius, ball["triangles"], material=red)
ground = scene.add_mesh(floor, [[0, 2, 1], [0, 3, 2]], material=grey)
scene.sky = (0.45, 0.5, 0.55), (0.15, 0.25, 0.5)
scene.add_light(kind="directional", direction=(-1, -2, -1), intensity=(0.9, 0.85, 0.75))
scene.camera = claray.Camera(position=(0, 2, 7), target=(0, 0.8, 0), vertical_fov=30)


# %% [markdown]
# Ball i starts at time i / 2, falls from a height of 2.4, and leaves to the right.


# %%
def place(time: float) -> None:
    ages = time - np.arange(12) / 2
    ages = ages[(ages >= 0) & (ages < 2)]
    transforms = np.tile(np.eye(4), (len(ages) + 1, 1, 1))
    transforms[1:, :3, :3] *= 0.35
    transforms[1:, 0, 3] = -1.6 + 1.6 * ages
    transforms[1:, 1, 3] = 0.35 + 2 * np.abs(np.cos(np.pi * ages)) * np.exp(-0.8 * ages)
    scene.set_instances([ground] + [unit] * len(ages), transforms)


place(0)
renderer = claray.Renderer(scene, width=options.width, height=options.width * 3 // 4, spp=options.spp)
frames: list[claray.Image] = []
for time in (0.0, 0.3, 0.8, 1.4, 2.0, 2.6):
    place(time)
    renderer.update(scene, instances=True)
    frames.append(renderer.image())
    print(f"at {time:.1f} s: {len(scene.instances['meshes']) - 1} balls")
strip = np.vstack([np.hstack(frames[:3]), np.hstack(frames[3:])]).view(claray.Image)
strip

# %%
if options.output:
    strip.save(options.output)
