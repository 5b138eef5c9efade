# %% [markdown]
# # A molecule
# Spheres and cylinders are traced as they are, without triangles: a helix of atoms and bonds.
#
#     python examples/python/molecule.py [-o molecule.png] [--spp 64] [--width 360]

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
# Two strands of 40 atoms each, and a bond between the strands at every second atom.

# %%
turn = np.linspace(0, 4 * np.pi, 40)
strands = [np.stack([np.cos(turn + shift), 0.25 * turn - np.pi / 2, np.sin(turn + shift)], axis=-1) for shift in (0, 2.4)]
atoms = np.concatenate(strands)
colours = np.repeat([[0.85, 0.2, 0.15], [0.2, 0.35, 0.85]], 40, axis=0)
ends = [(strand[:-1], strand[1:]) for strand in strands] + [(strands[0][::2], strands[1][::2])]

scene = claray.Scene()
paint = scene.add_material(kind="principled", albedo=(1, 1, 1), roughness=0.25)
metal = scene.add_material(kind="metal", albedo=(0.8, 0.8, 0.8), roughness=0.3)
scene.add_spheres(atoms, 0.16, material=paint, colors=colours)
scene.add_cylinders(np.concatenate([begin for begin, _ in ends]), np.concatenate([end for _, end in ends]), 0.06, material=metal)
scene.sky = (0.4, 0.4, 0.42), (0.1, 0.15, 0.25)
scene.add_light(kind="sun", direction=(-1, -1, -1), intensity=(1, 0.95, 0.9), outer_angle=0.05)
scene.camera = claray.Camera(position=(0, 0.4, 9), target=(0, 0, 0), vertical_fov=28)
print(f"{scene.primitive_count} primitives")
image = claray.render(scene, width=options.width, height=options.width, spp=options.spp)
image

# %%
if options.output:
    image.save(options.output)
