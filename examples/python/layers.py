# %% [markdown]
# # Layers
# What compositors need beside the image: depth, normals, albedo, numbers of materials, cost and error of each pixel.
#
#     python examples/python/layers.py [--scene SCENE] [-o layers.png] [--exr layers.exr] [--width 200]

# %%
import argparse

import numpy as np

import claray

parser = argparse.ArgumentParser()
parser.add_argument("--scene", default="crate")
parser.add_argument("-o", "--output")
parser.add_argument("--exr", help="a file for all layers")
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--width", type=int, default=200)
options = parser.parse_known_args()[0]  # a notebook has arguments of its own

# %%
renderer = claray.Renderer(claray.load(options.scene), width=options.width, height=options.width * 3 // 4, spp=options.spp)
image, aovs = renderer.image(), renderer.aovs()
error = renderer.error_map()
seen = aovs["primitive"] != claray.MISS
print(f"{seen.mean():.0%} of the pixels see a surface, the nearest at {aovs['depth'][seen].min():.3g}")
print(f"half the pixels are known to {np.median(error[seen]):.2g}")
if options.exr:
    image.save(options.exr, layers={**aovs, "error": error})

# %% [markdown]
# Each as a picture: the image, normals and albedo above; logarithm of the depth, materials and cost below.

# %%
depth = np.where(seen, np.log(aovs["depth"]), np.nan)
shown = [image.to_bytes()]
shown += [picture.astype(np.float32).view(claray.Image).to_bytes(tone_map="none") for picture in (0.5 + 0.5 * aovs["normal"], aovs["albedo"])]
shown += [picture.to_bytes() for picture in (claray.false_color(depth), claray.identifier_color(aovs["material"]),
                                             claray.false_color(aovs["heat"]))]
table = np.vstack([np.hstack(shown[:3]), np.hstack(shown[3:])])
linear = np.where(table <= 10.31475, table / 3294.6, ((table / 255 + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
picture = linear.astype(np.float32).view(claray.Image)
picture.tone_map = "none"
picture

# %%
if options.output:
    picture.save(options.output)
