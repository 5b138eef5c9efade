"""Shapes of USD as arrays."""

# pyright: basic
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Ints = NDArray[np.int64]
SEGMENTS = 32  # around cylinders and the like


def array_of(values: Any, columns: int = 0) -> NDArray[Any]:
    """A VtArray, or None, as rows."""
    array = np.asarray(values if values is not None else [], np.float32)
    return array.reshape(-1, columns) if columns else array


def taken(values: NDArray[Any], indices: Ints) -> NDArray[Any]:
    rows: NDArray[Any] = values[indices]
    return rows


def triangles_of(counts: Ints, holes: Ints) -> tuple[Ints, Ints]:
    """Corners (T, 3) of fans of polygons, and the polygon of each triangle. counts: corners of each polygon. holes: polygons that are left
    out."""
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]) if len(counts) else counts
    each = np.maximum(counts - 2, 0)
    if len(holes):
        each[holes[(holes >= 0) & (holes < len(each))]] = 0
    faces = np.repeat(np.arange(len(counts)), each)
    within = np.arange(len(faces)) - np.repeat(np.cumsum(each) - each, each)
    first = starts[faces]
    return np.stack([first, first + within + 1, first + within + 2], 1).astype(np.int64), faces


def smooth_normals(points: Floats, corners: Ints) -> Floats:
    """Of each point, from the triangles around it, by their areas."""
    a, b, c = (points[corners[:, i]].astype(np.float64) for i in range(3))
    of_triangles = np.cross(b - a, c - a)
    sums = np.zeros((len(points), 3))
    for i in range(3):
        np.add.at(sums, corners[:, i], of_triangles)
    return unit(sums)


def unit(vectors: NDArray[Any]) -> Floats:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    ok = np.isfinite(lengths) & (lengths > 1e-30)
    return np.where(ok, vectors / np.where(ok, lengths, 1), [0, 0, 1]).astype(np.float32)


Solid = tuple[Floats, Floats, Floats, Ints]
"""Points, normals, coordinates (v upwards) and triangles."""


def revolved(profile: Any, normals: Any, axis: str) -> Solid:
    """A curve in the plane of a radius and a height, turned about an axis. normals: in this plane; profile: from the lowest height."""
    profile, normals = np.asarray(profile, np.float64), np.asarray(normals, np.float64)
    angle = np.linspace(0, 2 * np.pi, SEGMENTS + 1)
    around = np.stack([np.cos(angle), np.sin(angle)], 1)

    def spread(curve: NDArray[Any]) -> NDArray[Any]:
        flat = np.concatenate([curve[:, None, :1] * around[None], np.repeat(curve[:, None, 1:], len(angle), 1)], 2)
        return flat.reshape(-1, 3)
    rows = len(profile)
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rows - 1), np.arange(SEGMENTS), indexing="ij"))
    a, width = i * (SEGMENTS + 1) + j, SEGMENTS + 1
    faces = np.concatenate([np.stack([a, a + 1, a + width + 1], 1), np.stack([a, a + width + 1, a + width], 1)])
    steps = np.linspace(0, 1, rows)
    uvs = np.stack([np.tile(angle / (2 * np.pi), rows), np.repeat(steps, len(angle))], 1).astype(np.float32)
    order = {"Z": [0, 1, 2], "X": [2, 0, 1], "Y": [1, 2, 0]}[axis]
    return (spread(profile)[:, order].astype(np.float32), unit(spread(normals)[:, order]), uvs, faces)


def sphere(radius: float) -> Solid:
    angle = np.linspace(-np.pi / 2, np.pi / 2, SEGMENTS // 2 + 1)
    curve = np.stack([np.cos(angle), np.sin(angle)], 1)
    return revolved(curve * radius, curve, "Z")


def capsule(radius: float, height: float, axis: str) -> Solid:
    low, high = np.linspace(-np.pi / 2, 0, 9), np.linspace(0, np.pi / 2, 9)
    curve = np.concatenate([np.stack([np.cos(a), np.sin(a)], 1) for a in (low, high)])
    shift = np.repeat([-height / 2, height / 2], 9)
    return revolved(curve * radius + np.stack([0 * shift, shift], 1), curve, axis)


def cylinder(radius: float, height: float, axis: str, top: float | None = None) -> Solid:
    """With caps. top: the radius there, 0 of a cone; None: as below."""
    half, top = height / 2, radius if top is None else top
    side = (height, radius - top)
    return revolved([(0, -half), (radius, -half), (radius, -half), (top, half), (top, half), (0, half)],
                    [(0, -1), (0, -1), side, side, (0, 1), (0, 1)], axis)


def cube(size: float) -> Solid:
    """Faces that are flat."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float64)
    points, normals = [], []
    for axis in range(3):
        for sign in (1, -1):
            square = np.zeros((4, 3))
            square[:, (axis + 1) % 3], square[:, (axis + 2) % 3] = corners[:, 0] * sign, corners[:, 1]
            square[:, axis] = sign
            points.append(square * size / 2)
            normals.append(np.tile(np.eye(3)[axis] * sign, (4, 1)))
    first = np.arange(6)[:, None] * 4
    faces = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]])
    return np.concatenate(points).astype(np.float32), np.concatenate(normals).astype(np.float32), \
        np.tile((corners + 1) / 2, (6, 1)).astype(np.float32), faces


def rectangle(width: float, height: float, axis: str = "Z", down: bool = False) -> Solid:
    """In the plane across the axis, seen from its positive side, or from its negative one."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float64)
    order = {"Z": [0, 1, 2], "X": [2, 0, 1], "Y": [1, 2, 0]}[axis]
    points = np.concatenate([corners * [width / 2, height / 2], np.zeros((4, 1))], 1)[:, order]
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    normal = np.array([0, 0, -1.0 if down else 1.0])[order]
    return points.astype(np.float32), np.tile(normal, (4, 1)).astype(np.float32), ((corners + 1) / 2).astype(np.float32), \
        faces[:, ::-1] if down else faces


def disc(radius: float, down: bool = False) -> Solid:
    points, normals, uvs, faces = revolved([(0, 0), (radius, 0)], [(0, -1), (0, -1)], "Z")
    return (points, normals, uvs, faces) if down else (points, -normals, uvs, faces[:, ::-1])
