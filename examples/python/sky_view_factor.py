"""The share of the sky that each place of a surface sees, weighted by the cosine: the sky view factor of city climate.

    python examples/python/sky_view_factor.py [SCENE] [-o factor.png]
"""

import argparse

import numpy as np

import claray


def sky_directions(count):
    """Directions over the horizontal plane (y up) with density cosine / pi, evenly spread (Vogel's spiral)."""
    i = np.arange(count) + 0.5
    radius, angle = np.sqrt(i / count), np.pi * (3 - np.sqrt(5)) * i
    return np.stack([radius * np.cos(angle), np.sqrt(1 - radius**2), radius * np.sin(angle)], axis=-1)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", nargs="?", default="terrain:200000")
    parser.add_argument("-o", "--output")
    parser.add_argument("--side", type=int, default=200)
    options = parser.parse_args()
    scene = claray.load(options.scene)
    bvh = claray.Bvh(scene)
    low, high = scene.bounds
    x, z = np.meshgrid(np.linspace(low[0], high[0], options.side), np.linspace(low[2], high[2], options.side))
    above = np.stack([x, np.full_like(x, high[1] + 1), z], axis=-1).reshape(-1, 3)
    down = claray.closest_hit(bvh, above, (0, -1, 0))
    offset = 1e-4 * float((high - low).max())
    places = above - (down["t"][:, None] - offset) * [0, 1, 0]
    places[down["primitive"] == claray.MISS] = above[0]
    directions = sky_directions(64)
    free = np.zeros(len(places))
    for direction in directions:  # one query for each direction: neighbours run side by side
        free += ~claray.any_hit(bvh, places, direction, coherence="coherent")
    factor = (free / len(directions)).reshape(options.side, options.side)
    print(f"sky view factor: least {factor.min():.2f}, mean {factor.mean():.2f}, largest {factor.max():.2f}")
    if options.output:
        image = np.repeat(factor[..., None], 3, axis=2).astype(np.float32).view(claray.Image)
        image.save(options.output, tone_map="none")


if __name__ == "__main__":
    main()
