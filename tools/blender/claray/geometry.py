# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of Blender as arrays."""

import numpy as np

# From Blender's axes, z upwards, to claray's, y upwards: (x, y, z) becomes (x, z, -y), as in files of glTF.
AXES = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


def turned(vector):
    """A vector in claray's axes."""
    return AXES[:3, :3] @ np.asarray(vector, np.float64)


def column(collection, name, count, width, kind=np.float32):
    values = np.empty(count * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(count, width) if width > 1 else values


def arrays_of(mesh, uv_maps, color):
    """What Scene.add_mesh takes: vertices, triangles, normals and so on, and `slots` (T,), the material slot of each triangle. None for a
    mesh without faces. uv_maps: up to two names of UV maps that are needed, "": the active one. color: the name of the colours of vertices
    that are needed, "": the active ones; None: none."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == 0:
        return None
    points = column(mesh.vertices, "co", len(mesh.vertices), 3)
    made = {"slots": column(mesh.loop_triangles, "material_index", count, 1, np.int32)}
    domain = mesh.normals_domain
    layers = [_uv_layer(mesh, name) for name in uv_maps]
    colors = _colors(mesh, color)
    if domain == "CORNER" or any(layer is not None for layer in layers) or colors is not None:
        corners = column(mesh.loops, "vertex_index", len(mesh.loops), 1, np.int32)
        made.update(vertices=points[corners], triangles=column(mesh.loop_triangles, "loops", count, 3, np.int32))
        if domain != "FACE":
            made["normals"] = _unit(column(mesh.corner_normals, "vector", len(mesh.loops), 3))
        for key, layer in zip(("uvs", "uvs1"), layers):
            if layer is not None:
                uvs = column(layer.uv, "vector", len(mesh.loops), 2)
                uvs[:, 1] = 1 - uvs[:, 1]  # claray's v runs downwards
                made[key] = uvs
        if colors is not None:
            made["colors"] = colors[corners] if len(colors) == len(points) else colors
    else:
        made.update(vertices=points, triangles=column(mesh.loop_triangles, "vertices", count, 3, np.int32))
        if domain == "POINT":
            made["normals"] = _unit(column(mesh.vertex_normals, "vector", len(mesh.vertices), 3))
    return made


def _unit(normals):
    """Of unit length; those of faces without area, which have none, are upwards."""
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(lengths > 1e-6, normals / np.where(lengths > 1e-6, lengths, 1), np.float32([0, 0, 1])).astype(np.float32)


def _uv_layer(mesh, name):
    if name:
        return mesh.uv_layers.get(name)
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def _colors(mesh, name):
    """(V, 4) or (loops, 4), linear."""
    if name is None:
        return None
    attributes = mesh.color_attributes
    found = attributes.get(name) if name else attributes.get(attributes.default_color_name) if len(attributes) else None
    if found is None or found.domain not in ("POINT", "CORNER"):
        return None
    colors = np.clip(column(found.data, "color", len(found.data), 4), 0, 1)
    colors[:, 3] = 1  # which claray would take as opacity
    return colors


def ball(subdivisions=2):
    """Vertices and triangles of a sphere of radius 1, from an icosahedron; outwards."""
    g = (1 + 5 ** 0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1),
              (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    corners = np.array(points, np.float64)[np.array(faces)]
    for _ in range(subdivisions):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = a + b, b + c, c + a  # halfway, at another length
        scale = np.linalg.norm(a, axis=1, keepdims=True)
        ab, bc, ca = (m / np.linalg.norm(m, axis=1, keepdims=True) * scale for m in (ab, bc, ca))
        corners = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    return corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)


def disc(segments=48):
    """Vertices and triangles of a disc of radius 1 in the plane z = 0, seen from -z, where lamps of Blender shine to."""
    angle = np.arange(segments) * (2 * np.pi / segments)
    rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(segments)], 1)
    i = np.arange(segments)
    return np.vstack([rim, [[0, 0, 0]]]), np.stack([(i + 1) % segments, i, np.full(segments, segments)], 1)


def square():
    """The square of side 2 in the plane z = 0, seen from -z."""
    return np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float64), np.array([[2, 1, 0], [3, 2, 0]])


def area_of(points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
