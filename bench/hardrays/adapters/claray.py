"""claray, with its default device and builder."""

import claray

PACKAGE, LIMITS = "claray", ("tmin", "tmax")
occluded = claray.any_hit
count_hits = claray.count_hits
inside = claray.inside


def make(positions, triangles):
    return claray.Bvh(positions, triangles, nan="omit")


def closest_hit(bvh, origins, directions, **limits):
    hits = claray.closest_hit(bvh, origins, directions, **limits)
    return hits["primitive"] != claray.MISS, hits["t"], hits["primitive"]


def distance(bvh, points):
    return claray.nearest_point(bvh, points)["distance"]
