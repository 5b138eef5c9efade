"""claray, with its default device and builder, by rays in its own format."""

import claray
import numpy as np

PACKAGE = "claray"


def make(positions, triangles):
    bvh = claray.Bvh(positions, triangles)
    bvh.device.finish()  # a build goes on after its call
    return bvh


def closest(bvh, origins, directions, coherent):
    rays = claray.rays(origins, directions)
    return lambda: claray.closest_hit(bvh, rays)


def any_hit(bvh, origins, directions, coherent):
    rays = claray.rays(origins, directions, tmax=1.0)
    return lambda: claray.any_hit(bvh, rays)


def count(found):
    return int(np.count_nonzero(found["primitive"] != claray.MISS if found.dtype.names else found))
