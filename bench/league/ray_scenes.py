"""Meshes and rays of rays.py, as folders of .npy files that every tracer's process reads."""

import os
import sys

import numpy as np

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(FOLDER, "../hardrays"), os.path.join(FOLDER, "../renderers")]

import scenes  # noqa: E402
import shapes  # noqa: E402

KINDS = ("primary", "shadow", "bounce", "random")
COHERENT = ("primary",)


def of_renderers(name):
    """A scene of bench/renderers, with its camera."""
    scene = scenes.all_scenes()[name]()
    mesh = scenes.merged(*(part[0] for part in scene["parts"]))
    return *mesh, scene["eye"], scene["target"], scene["fov"]


def seen(mesh, fov=45, towards=(0.5, 0.4, 0.8)):
    """A view of all of a mesh from outside."""
    low, high = mesh[0].min(0).astype(float), mesh[0].max(0).astype(float)
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    return *mesh, middle + size * np.array(towards), middle, fov


def terrain(side=354):
    """Hills of 2 * 353^2 = 249,218 triangles."""
    x, y = np.meshgrid(np.arange(side) / side, np.arange(side) / side, indexing="ij")
    heights = sum(np.sin(a * x + 1.7 * a) * np.cos(b * y + b) / max(a, b) for a, b in ((5, 7), (11, 9), (23, 31), (61, 47), (130, 170)))
    points, triangles = shapes.grid(0.12 * side * heights)
    return seen((points[:, [1, 2, 0]], triangles))


def needles(count=60_000):
    """Triangles two hundred times as long as wide, in all directions."""
    rng = np.random.default_rng(5)
    start, along = rng.uniform(-1, 1, (count, 3)), rng.normal(size=(count, 3))
    along *= 0.2 / np.linalg.norm(along, axis=1, keepdims=True)
    across = np.cross(along, rng.normal(size=(count, 3)))
    across *= 0.001 / np.linalg.norm(across, axis=1, keepdims=True)
    return seen((np.stack([start, start + along, start + across], 1).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)))


def soup(count=100_000):
    rng = np.random.default_rng(6)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.uniform(-0.02, 0.02, (count, 3, 3))
    return seen((corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)))


def of_file(path):
    """From within for what is a building, which is wide and has a floor; else from outside."""
    scene = scenes.sponza(path)
    if os.path.basename(path).startswith(("sponza", "sibenik")):
        return *scene["parts"][0][0], scene["eye"], scene["target"], scene["fov"]
    return seen(scene["parts"][0][0])


MADE = {"hall": lambda: of_renderers("hall"), "studio": lambda: of_renderers("studio"), "glass": lambda: of_renderers("glass"),
        "terrain": terrain, "needles": needles, "soup": soup}
FILES = ("sponza.obj", "sibenik.obj", "bunny.obj", "igea.obj")


def known(files):
    """Functions that make the scenes."""
    there = [name for name in FILES if files and os.path.exists(os.path.join(files, name))]
    return {**MADE, **{name[:-4]: lambda name=name: of_file(os.path.join(files, name)) for name in there}}


def unit(v):
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def primary_rays(side, eye, target, fov):
    eye, forward = np.array(eye, float), unit(np.array(target, float)[None] - np.array(eye, float))[0]
    right = unit(np.cross(forward, (0, 1, 0))[None])[0]
    across, down = np.meshgrid((np.arange(side) + 0.5) / side * 2 - 1, (np.arange(side) + 0.5) / side * 2 - 1)
    half = np.tan(np.radians(fov) / 2)
    towards = forward + half * (across[..., None] * right - down[..., None] * np.cross(right, forward))
    return np.broadcast_to(eye, (side * side, 3)), towards.reshape(-1, 3)


def rays_of(kind, side, scene, first):
    """`first`: hits of the primary rays, as rows, normals and places."""
    positions, _, eye, target, fov = scene
    if kind == "primary":
        return primary_rays(side, eye, target, fov)
    rng = np.random.default_rng(KINDS.index(kind))
    low, high = positions.min(0), positions.max(0)
    if kind == "random":
        origins = rng.uniform(low, high, (side * side, 3))
        return origins, rng.normal(size=origins.shape)
    normals, places = first
    origins = places + 1e-4 * np.linalg.norm(high - low) * normals
    if kind == "bounce":
        return origins, unit(normals + 0.999 * unit(rng.normal(size=normals.shape)))
    lamps = np.array([[0.3, 0.85, 0.3], [0.7, 0.9, 0.55], [0.5, 1.3, 0.8]])[rng.integers(3, size=len(origins))]
    return origins, low + (high - low) * lamps - origins


def first_hits(positions, triangles, origins, directions):
    """Normals against the rays, and places, in the order of the rays that hit."""
    import claray

    found = claray.closest_hit(claray.Bvh(positions, triangles), origins, directions)
    hit = found["primitive"] != claray.MISS
    corners = positions[triangles[found["primitive"][hit]]].astype(float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    towards = directions[hit].astype(float)
    normals *= -np.sign((normals * towards).sum(1, keepdims=True))
    kept = np.linalg.norm(normals, axis=1) > 0
    return unit(normals[kept]), (origins[hit] + found["t"][hit, None] * towards)[kept]


def write(scene, side, folder):
    """Writes the arrays; returns the number of rays of each kind."""
    save = lambda name, values: np.save(os.path.join(folder, name), values)
    scene = scene[0].astype(np.float32), scene[1].astype(np.uint32), *scene[2:]
    save("positions", scene[0]), save("triangles", scene[1])
    counts, first = {}, None
    for kind in KINDS:
        origins, directions = (np.ascontiguousarray(a, np.float32) for a in rays_of(kind, side, scene, first))
        if kind == "primary":
            first = first_hits(*scene[:2], origins, directions)
        save(kind + "_origins", origins), save(kind + "_directions", directions)
        counts[kind] = len(origins)
    return counts
