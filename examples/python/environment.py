# %% [markdown]
# # Environment
# An evening sky, painted into an array of latitude and longitude, lights a ball of metal.
#
#     python examples/python/environment.py [-o environment.png] [--spp 64] [--width 360]

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
# Rows go from the zenith down, the middle column is towards -z. The sun is 400 times as bright as the sky around it.

# %%
latitude = np.linspace(np.pi / 2, -np.pi / 2, 256)[:, None]
longitude = np.linspace(-np.pi, np.pi, 512)[None]
above = np.clip(np.sin(latitude), 0, 1)[..., None]
sky = (1 - above) ** 4 * [1.0, 0.45, 0.2] + (1 - (1 - above) ** 4) * [0.1, 0.2, 0.5]
ground = np.array([0.08, 0.07, 0.06])
panorama = np.where(latitude[..., None] > 0, sky, ground) * np.ones((256, 512, 1))
to_sun = np.cos(latitude) * np.cos(latitude * 0 + 0.15) * np.cos(longitude - 0.9) + np.sin(latitude) * np.sin(0.15)
panorama += 400 * np.exp((to_sun[..., None] - 1) * 3000) * [1.0, 0.7, 0.4]

# %%
scene = claray.load("effect:metal")
scene.lights = []
scene.environment = claray.Environment(panorama.astype(np.float32), strength=1.0, rotation=np.radians(200))
renderer = claray.Renderer(scene, width=options.width, height=options.width * 2 // 3, spp=options.spp)
progress = renderer.render()
print(f"{progress['spp']} samples per pixel, noise {progress['noise']:.3f}")
image = renderer.image(denoise="claray")
image

# %%
if options.output:
    image.save(options.output)
