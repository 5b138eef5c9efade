"""The right answers of points: squared distances and sides of closed convex meshes, by Python's integers."""

from fractions import Fraction

import numpy as np

from answers import EITHER, ULP
from exact import as_integers, cross, dot, sign


def nearest_possible(corners, points):
    """Pairs of points and triangles that may be nearest: bounding spheres and planes are nearer than some centroid."""
    c = corners.mean(axis=1)
    reach = np.sqrt(((corners - c[:, None]) ** 2).sum(axis=2).max(axis=1))
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.sqrt(dot(normals, normals))[:, None]
    step = max(1, (1 << 21) // len(c))
    for first in range(0, len(points), step):
        away = points[first:first + step, None] - c
        distance = np.sqrt(dot(away, away))
        slack = 1e-12 * (abs(points[first:first + step]).max() + abs(corners).max())
        least = np.maximum(distance - reach, abs(dot(away, normals)))
        point, triangle = np.nonzero(least <= distance.min(axis=1)[:, None] + slack)
        yield point + first, triangle


def squared_distance(p, a, b, c):
    """The exact squared distance of integer points from integer triangles, as a list of fractions."""
    ab, ac, bc = b - a, c - a, c - b
    n = cross(ab, ac)
    inside = np.ones(len(p), bool)
    for start, edge in ((a, ab), (b, bc), (c, a - c)):
        inside &= dot(cross(edge, p - start), n) >= 0
    height, size = dot(p - a, n), dot(n, n)
    best = [Fraction(int(h) ** 2, int(s)) if i and s else None for h, s, i in zip(height, size, inside)]
    for start, edge in ((a, ab), (b, bc), (a, ac)):
        for k, value in enumerate(from_segment(p - start, edge)):
            best[k] = value if best[k] is None or value < best[k] else best[k]
    return best


def from_segment(away, edge):
    along, size, square = dot(away, edge), dot(edge, edge), dot(away, away)
    behind = away - edge
    for s, e, q, r in zip(along, size, square, dot(behind, behind)):
        yield Fraction(int(q)) if s <= 0 else Fraction(int(r)) if s >= e else Fraction(int(q * e - s * s), int(e))


def answers_of_points(positions, triangles, points):
    """Exact squared distances rounded to float64, whether the point is inside, and the tolerance of a distance."""
    corners, p = positions.astype(np.float64)[triangles], points.astype(np.float64)
    point, triangle = (np.concatenate(a) for a in zip(*nearest_possible(corners, p)))
    (q, v), shift = as_integers(p, corners)
    best = [None] * len(p)
    for i, value in zip(point, squared_distance(q[point], *(v[triangle, k] for k in range(3)))):
        if best[i] is None or value < best[i]:
            best[i] = value
    squares = np.array([float(x / 4 ** shift if shift >= 0 else x * 4 ** -shift) for x in best])
    largest = np.maximum(abs(p).max(axis=1), abs(corners).max())
    return {"squared_distance": squares, "inside": inside_convex(v, q), "tolerance": 4 * ULP * largest}


def inside_convex(corners, points):
    """1 inside, 0 outside, 2 on the surface."""
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    offset = dot(corners[:, 0], normals)
    outermost = np.array([max(dot(p[None], normals) - offset) for p in points], object)
    return np.where(sign(outermost) < 0, 1, np.where(sign(outermost) > 0, 0, EITHER)).astype(np.uint8)
