"""Meshes of the scenes that are written as glTF: (positions, normals, texture coordinates, triangles). v points downwards, as in glTF."""
import numpy as np

from scenes import sides_of_box


def quad(center, u, v):
    center, u, v = (np.array(x, np.float32) for x in (center, u, v))
    n = np.cross(u, v)
    corners = np.array([center - u - v, center + u - v, center + u + v, center - u + v], np.float32)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)  # v downwards, as in glTF
    return corners, np.tile(n / np.linalg.norm(n), (4, 1)).astype(np.float32), uvs, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


def ball(center, radius, rows=48):
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    n = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], -1).reshape(-1, 3)
    uvs = np.stack([phi / (2 * np.pi), theta / np.pi], -1).reshape(-1, 2)
    a = (np.arange(rows)[:, None] * (2 * rows + 1) + np.arange(2 * rows)[None]).reshape(-1)
    b = a + 2 * rows + 1
    triangles = np.concatenate([np.stack([a, b, b + 1], -1), np.stack([a, b + 1, a + 1], -1)])
    p = np.array(center) + radius * n
    area = np.linalg.norm(np.cross(p[triangles[:, 1]] - p[triangles[:, 0]], p[triangles[:, 2]] - p[triangles[:, 0]]), axis=1)
    return p.astype(np.float32), n.astype(np.float32), uvs.astype(np.float32), triangles[area > 1e-9].astype(np.uint32)


def merged(*meshes):
    first = np.cumsum([0] + [len(m[0]) for m in meshes])
    triangles = np.concatenate([m[3] + n for m, n in zip(meshes, first)])
    return (*(np.concatenate([m[k] for m in meshes]) for k in range(3)), triangles.astype(np.uint32))


def box(center, half, turn=0.0, bottom=True):
    return merged(*(quad(*side) for side in sides_of_box(center, half, turn, bottom)))


def lathe(profile, center, around=64):
    """Turns points (radius, height) around the y axis. The outside is to their right."""
    p = np.array(profile, float)
    along = np.gradient(p, axis=0)
    out = np.stack([along[:, 1], -along[:, 0]], 1)
    out /= np.linalg.norm(out, axis=1)[:, None]
    angle = np.linspace(0, 2 * np.pi, around + 1)

    def turned(q):
        height = np.broadcast_to(q[:, None, 1], (len(q), around + 1))
        return np.stack([q[:, None, 0] * np.sin(angle), height, q[:, None, 0] * np.cos(angle)], -1).reshape(-1, 3)

    positions = turned(p) + center
    i = (np.arange(len(p) - 1)[:, None] * (around + 1) + np.arange(around)).reshape(-1)
    j = i + around + 1
    triangles = np.concatenate([np.stack([i, i + 1, j + 1], -1), np.stack([i, j + 1, j], -1)])
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    triangles = triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-10]
    return positions.astype(np.float32), turned(out).astype(np.float32), np.zeros((len(positions), 2), np.float32), triangles.astype(np.uint32)
