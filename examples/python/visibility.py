"""Which places of a terrain see each other: the share that is visible from a tower, by the tower's height.

    python examples/python/visibility.py [SCENE]
"""

import sys

import numpy as np

import claray


def main():
    scene = claray.load(sys.argv[1] if len(sys.argv) > 1 else "terrain:200000")
    bvh = claray.Bvh(scene)
    low, high = scene.bounds
    x, z = np.meshgrid(np.linspace(low[0], high[0], 300)[1:-1], np.linspace(low[2], high[2], 300)[1:-1])
    above = np.stack([x, np.full_like(x, high[1] + 1), z], axis=-1).reshape(-1, 3)
    ground = claray.closest_hit(bvh, above, (0, -1, 0))
    on_ground = ground["primitive"] != claray.MISS
    places = above[on_ground] - ground["t"][on_ground, None] * [0, 1, 0]
    middle = places[np.abs(places[:, [0, 2]] - 0.5 * (low + high)[[0, 2]]).sum(axis=1).argmin()]
    for height in (0.01, 0.05, 0.2):
        tower = middle + [0, height * (high - low)[1], 0]
        seen = claray.unoccluded(bvh, tower, places)
        print(f"a tower of {height:4.0%} of the relief sees {seen.mean():6.1%} of {len(places)} places")


if __name__ == "__main__":
    main()
