"""Exact arithmetic on float32 numbers: signs of volumes, and distances along rays.

A float32 number is an integer times a power of two. Signs are computed in float64 with a bound on the error; where the bound
leaves a sign open, Python's integers decide.
"""

import numpy as np

U = 2.0 ** -53


def as_integers(*arrays):
    """The arrays times one power of two, as Python's integers, and the exponent of that power."""
    lowest = min((np.frexp(a[a != 0])[1].min() for a in arrays if (a != 0).any()), default=0)
    shift = 24 - int(lowest)
    return [integers(np.ldexp(np.asarray(a, np.float64), shift)) for a in arrays], shift


def integers(values):
    out = np.empty(values.shape, object)
    out.ravel()[:] = [int(x) for x in values.ravel()]
    return out


def cross(a, b):
    return np.stack([a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
                     a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
                     a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]], axis=-1)


def dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def permanent(d, a, b):
    """The sum of the sizes of the six products of dot(d, cross(a, b))."""
    d, a, b = abs(d), abs(a), abs(b)
    return (d[..., 0] * (a[..., 1] * b[..., 2] + a[..., 2] * b[..., 1]) + d[..., 1] * (a[..., 2] * b[..., 0] + a[..., 0] * b[..., 2]) +
            d[..., 2] * (a[..., 0] * b[..., 1] + a[..., 1] * b[..., 0]))


def sign(values):
    return ((values > 0).astype(np.int8) - (values < 0).astype(np.int8)).astype(np.int8)


def edges_of(origins, corners):
    """The three pairs of differences whose volumes with the direction are the weights of the three corners."""
    a, b, c = (corners[:, k] - origins for k in range(3))
    return (b, c), (c, a), (a, b)


def volumes(origins, directions, corners):
    """For each corner the volume, in float64, and a bound on its error."""
    for p, q in edges_of(origins, corners):
        yield dot(directions, cross(p, q)), 16 * U * permanent(directions, p, q)


def certainly_misses(origins, directions, corners):
    """Whether the volumes have different signs, beyond doubt."""
    above = below = np.zeros(len(origins), bool)
    for value, bound in volumes(origins, directions, corners):
        above, below = above | (value > bound), below | (value < -bound)
    return above & below


def side_signs(origins, directions, corners):
    """(n, 3) signs: on which side of the edges opposite to the three corners the lines pass."""
    signs = np.empty((len(origins), 3), np.int8)
    doubtful = np.zeros(len(origins), bool)
    for k, (value, bound) in enumerate(volumes(origins, directions, corners)):
        signs[:, k] = sign(value)
        doubtful |= abs(value) <= bound
    rows = np.flatnonzero(doubtful)
    if len(rows):
        (o, d, v), _ = as_integers(origins[rows], directions[rows], corners[rows])
        for k, (p, q) in enumerate(edges_of(o, v)):
            signs[rows, k] = sign(dot(d, cross(p, q)))
    return signs


def broken_signs(origins, directions, corners, signs):
    """The signs with zeros broken: those of the direction (x + e, y + e^2, z + e^3) for a tiny e.

    The volume is linear in the direction, so that its change has the sign of the first component of the cross product that is
    not zero. Two triangles get opposite signs at their edge, so that a surface has no gap there.
    """
    broken = signs.copy()
    rows = np.flatnonzero((signs == 0).any(axis=1))
    if len(rows):
        (o, v), _ = as_integers(origins[rows], corners[rows])
        for k, (p, q) in enumerate(edges_of(o, v)):
            changes = sign(cross(p, q))
            for axis in range(3):
                open_rows = rows[broken[rows, k] == 0]
                broken[open_rows, k] = changes[np.isin(rows, open_rows), axis]
    return broken


def distances(origins, directions, corners):
    """Where the lines meet the planes: numerators and positive denominators, as Python's integers."""
    (o, d, v), _ = as_integers(origins, directions, corners)
    normals = cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0])
    above, below = dot(v[:, 0] - o, normals), dot(d, normals)
    turn = np.where(below < 0, -1, 1).astype(object)
    return above * turn, below * turn


def quotients(above, below):
    """The fractions, rounded to the nearest float64."""
    return np.array([a / b for a, b in zip(above, below)], np.float64)
