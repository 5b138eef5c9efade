"""Random numbers and meshes. All use integers, + - * / and square roots, which every machine rounds alike."""

import numpy as np

from exact import cross, dot


class Numbers:
    """Random integers from the raw words of PCG64, which do not depend on NumPy's version."""

    def __init__(self, seed):
        self._source = np.random.PCG64(seed)

    def integers(self, below, shape):
        """From 0 to below - 1, where below is at most 2^24. The bias is below 2^-16."""
        words = self._source.random_raw(int(np.prod(shape))) >> np.uint64(24)
        return ((words * np.uint64(below)) >> np.uint64(40)).astype(np.int64).reshape(shape)

    def between(self, low, high, shape):
        """Multiples of 2^-24 of the interval, as float64."""
        return low + (high - low) * (self.integers(1 << 24, shape) / float(1 << 24))

    def order(self, count):
        return np.argsort(self._source.random_raw(count), kind="stable")

    def directions(self, count):
        """Unit vectors, up to rounding."""
        out = np.zeros((0, 3))
        while len(out) < count:
            v = self.between(-1, 1, (2 * count + 16, 3))
            size = dot(v, v)
            out = np.concatenate([out, v[(size > 0.01) & (size <= 1)]])
        return unit(out[:count])


def unit(v):
    return v / np.sqrt(dot(v, v))[..., None]


def ball(levels, radius=1.0, center=(0.0, 0.0, 0.0)):
    """A closed convex mesh of 20 * 4^levels triangles, its vertices rounded to float32."""
    g = (1 + np.sqrt(5.0)) / 2
    points = unit(np.array([[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g],
                            [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]))
    triangles = np.array([[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
                          [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
                          [8, 6, 7], [9, 8, 1]])
    for _ in range(levels):
        points, triangles = split(points, triangles)
    return (points * radius + np.array(center)).astype(np.float32), triangles.astype(np.uint32)


def split(points, triangles):
    """Four triangles for each, with the middles of edges moved to the sphere."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    middles = unit(points[edges[:, 0]] + points[edges[:, 1]])
    ab, bc, ca = number.reshape(3, -1) + len(points)
    a, b, c = triangles.T
    parts = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.concatenate([points, middles]), np.concatenate([np.stack(part, axis=1) for part in parts])


def grid(heights, step=1.0, corner=(0.0, 0.0)):
    """A surface over a grid: heights of shape (n, m). Diagonals alternate."""
    n, m = heights.shape
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    points = np.stack([corner[0] + step * i, corner[1] + step * j, heights], axis=-1).reshape(-1, 3)
    number = (i * m + j)[:-1, :-1].ravel()
    a, b, c, d = number, number + m, number + m + 1, number + 1
    even = ((i + j)[:-1, :-1].ravel() % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    second = np.where(even, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    return points.astype(np.float32), np.concatenate([first, second]).astype(np.uint32)


def box(side, size, center=(0.0, 0.0, 0.0)):
    """A closed box whose faces are grids of side * side squares. Vertices are integers times size / side."""
    points, triangles, count = [], [], 0
    flat, faces = grid(np.zeros((side + 1, side + 1)))
    for axis in range(3):
        for top in (0, 1):
            p = np.empty((len(flat), 3))
            p[:, axis], p[:, (axis + 1) % 3], p[:, (axis + 2) % 3] = side * top, flat[:, 0], flat[:, 1]
            points.append(p)
            triangles.append((faces if top else faces[:, ::-1]) + count)
            count += len(flat)
    p = (np.concatenate(points) / side - 0.5) * size + np.array(center)
    return weld(p.astype(np.float32), np.concatenate(triangles))


def octahedron(center, radius):
    points = np.concatenate([np.eye(3), -np.eye(3)]) * radius + np.array(center)
    triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return points.astype(np.float32), np.array(triangles, np.uint32)


def weld(positions, triangles):
    """Equal positions become one vertex."""
    points, number = np.unique(positions + np.float32(0), axis=0, return_inverse=True)
    return points, number.ravel()[triangles].astype(np.uint32)


def join(*meshes):
    points, triangles, count = [], [], 0
    for p, t in meshes:
        points.append(p)
        triangles.append(t.astype(np.int64) + count)
        count += len(p)
    return np.concatenate(points), np.concatenate(triangles).astype(np.uint32)


def circle(count):
    """Points of the unit circle, by its rational parametrisation."""
    s = (np.arange(count // 4) + 0.5) / (count // 4)
    x, y = (1 - s * s) / (1 + s * s), 2 * s / (1 + s * s)
    return np.concatenate([np.stack(q, axis=1) for q in ((x, y), (-y, x), (-x, -y), (y, -x))])


def fan(count, height=1.0):
    """A closed double cone: two vertices, each of `count` thin triangles."""
    rim = np.concatenate([circle(count), np.zeros((count, 1))], axis=1)
    points = np.concatenate([rim, [[0, 0, height], [0, 0, -height]]])
    i = np.arange(count)
    j = (i + 1) % count
    top, bottom = np.full(count, count), np.full(count, count + 1)
    return points.astype(np.float32), np.concatenate([np.stack([i, j, top], 1), np.stack([j, i, bottom], 1)]).astype(np.uint32)


def points_of(mesh, kinds, numbers, count):
    """Points in faces, on edges or at vertices, in float64, and their triangles."""
    corners = mesh[0].astype(np.float64)[mesh[1]]
    chosen = numbers.integers(len(corners), count)
    weights = 1.0 + numbers.integers(1 << 20, (count, 3))
    kind = np.asarray(kinds, object)[np.arange(count) % len(kinds)]
    weights[kind != "face", 2] = 0
    weights[kind == "vertex", 1] = 0
    weights = np.where(numbers.integers(2, count)[:, None] == 1, weights, weights[:, [2, 0, 1]])
    weights /= (weights[:, 0] + weights[:, 1] + weights[:, 2])[:, None]
    v = corners[chosen]
    return v[:, 0] * weights[:, :1] + v[:, 1] * weights[:, 1:2] + v[:, 2] * weights[:, 2:], chosen


def normals_of(mesh):
    v = mesh[0].astype(np.float64)[mesh[1]]
    return unit(cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]))
