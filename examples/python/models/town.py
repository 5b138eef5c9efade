"""A town of about a million triangles, with cars that drive and people who walk; metres, z is up.

    town = Town()
    scene = town.scene()                         # a claray.Scene: instance 0 is the ground with all houses and trees
    town.motion(seconds, duration), town.movers  # where cars and people are, and their instances
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

import claray

BLOCK, STREET = 62.0, 16.0  # sides of a block and width of the streets between
PITCH = BLOCK + STREET

# Name, colour, and reflectance in the near infrared, relative to a white surface: plausible ones, not measured ones.
MATERIALS = [
    ("asphalt", (0.09, 0.09, 0.10), 0.15), ("pavement", (0.36, 0.35, 0.33), 0.35), ("grass", (0.14, 0.25, 0.07), 0.50),
    ("plaster", (0.72, 0.64, 0.50), 0.60), ("brick", (0.42, 0.20, 0.14), 0.45), ("concrete", (0.50, 0.52, 0.54), 0.40),
    ("glass", (0.10, 0.14, 0.18), 0.03), ("roof", (0.34, 0.15, 0.11), 0.30), ("bark", (0.20, 0.14, 0.09), 0.30),
    ("leaves", (0.10, 0.26, 0.06), 0.55), ("red paint", (0.55, 0.05, 0.05), 0.50), ("blue paint", (0.05, 0.13, 0.45), 0.10),
    ("white paint", (0.75, 0.75, 0.75), 0.75), ("tyre", (0.03, 0.03, 0.03), 0.04), ("reflector", (0.9, 0.85, 0.3), 40.0),
    ("skin", (0.55, 0.36, 0.27), 0.55), ("cloth", (0.16, 0.20, 0.33), 0.40), ("marking", (0.85, 0.85, 0.85), 0.85),
]
NUMBER = {name: i for i, (name, _, _) in enumerate(MATERIALS)}
REFLECTANCE = np.array([value for _, _, value in MATERIALS])

Floats = NDArray[np.float64]
Vector = Sequence[float] | Floats  # (3,)


class Shape:
    """Triangles by material, which grow by parts."""

    def __init__(self) -> None:
        self.parts: dict[str, list[Floats]] = {}

    def add(self, material: str, corners: ArrayLike) -> None:
        """corners: (T, 3, 3)."""
        self.parts.setdefault(material, []).append(np.asarray(corners, np.float64).reshape(-1, 3, 3))

    def quads(self, material: str, a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> None:
        """Quadrilaterals a b c d, counter-clockwise seen from outside; (..., 3) each."""
        a, b, c, d = (np.broadcast_to(p, np.broadcast_shapes(*map(np.shape, (a, b, c, d)))).reshape(-1, 3) for p in (a, b, c, d))
        self.add(material, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))

    def box(self, material: str, low: Vector, high: Vector) -> None:
        x, y, z = np.array([low, high], np.float64).T
        p = np.array([[x[i & 1], y[i >> 1 & 1], z[i >> 2]] for i in range(8)])
        for face in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
            self.quads(material, *p[list(face)])

    def ball(self, material: str, center: Vector, radii: Vector, rows: int = 6, columns: int = 10, roughness: float = 0.0,
             random: np.random.Generator | None = None) -> None:
        theta, phi = np.linspace(0, np.pi, rows + 1)[:, None], np.linspace(0, 2 * np.pi, columns + 1)[None]
        size = np.ones((rows + 1, columns + 1))
        if random is not None:
            size += roughness * random.uniform(-1, 1, size.shape)
            size[:, -1], size[0], size[-1] = size[:, 0], size[0, 0], size[-1, 0]
        p = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), -1)
        p = p * size[..., None] * radii + center
        self.add(material, np.stack([p[1:-1, :-1], p[2:, :-1], p[1:-1, 1:]], 2))
        self.add(material, np.stack([p[:-2, 1:], p[1:-1, :-1], p[1:-1, 1:]], 2))
        self.add(material, np.stack([p[1:-1, 1:], p[2:, :-1], p[2:, 1:]], 2)[:-1])

    def cylinder(self, material: str, start: Vector, end: Vector, radius: float, sides: int = 10) -> None:
        start, end = np.asarray(start, np.float64), np.asarray(end, np.float64)
        along = (end - start) / np.linalg.norm(end - start)
        across = np.cross(along, (0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (1.0, 0.0, 0.0))
        across /= np.linalg.norm(across)
        turn = np.linspace(0, 2 * np.pi, sides + 1)[:, None]
        ring = radius * (np.cos(turn) * across + np.sin(turn) * np.cross(along, across))
        self.quads(material, start + ring[:-1], start + ring[1:], end + ring[1:], end + ring[:-1])
        for center, first, second in ((end, ring[:-1], ring[1:]), (start, ring[1:], ring[:-1])):
            self.add(material, np.stack(np.broadcast_arrays(center, center + first, center + second), 1))

    def moved(self, offset: Vector, turn: float = 0.0) -> Shape:
        rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        shape = Shape()
        for material, parts in self.parts.items():
            shape.add(material, np.concatenate(parts) @ rotation.T + offset)
        return shape

    def join(self, other: Shape) -> None:
        for material, parts in other.parts.items():
            self.parts.setdefault(material, []).extend(parts)

    def arrays(self) -> tuple[Floats, NDArray[np.uint32], NDArray[np.uint32]]:
        """Vertices (3 T, 3), triangles (T, 3) and their materials (T,)."""
        corners = np.concatenate([part for parts in self.parts.values() for part in parts])
        materials = np.concatenate([np.full(len(part), NUMBER[name], np.uint32) for name, parts in self.parts.items() for part in parts])
        return corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.uint32).reshape(-1, 3), materials


def wall(shape: Shape, material: str, origin: Floats, along: Floats, width: float, floors: int, columns: int,
         storey: float = 3.2) -> None:
    """A wall of cells, each with a window in a recess. `along` is a unit vector; outside is to its right."""
    up = np.array([0.0, 0.0, 1.0])
    inwards = np.cross(up, along)
    u, v = np.meshgrid(np.arange(columns), np.arange(floors), indexing="ij")
    cell = width / columns

    def at(x: float, z: float, depth: float = 0.0) -> Floats:
        points: Floats = origin + ((u + x) * cell)[..., None] * along + ((v + z) * storey)[..., None] * up + depth * inwards
        return points

    xs, zs = (0.0, 0.25, 0.75, 1.0), (0.0, 0.3, 0.85, 1.0)
    outer = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)]
    inner = [at(xs[1], zs[1]), at(xs[2], zs[1]), at(xs[2], zs[2]), at(xs[1], zs[2])]
    deep = [at(xs[1], zs[1], 0.25), at(xs[2], zs[1], 0.25), at(xs[2], zs[2], 0.25), at(xs[1], zs[2], 0.25)]
    for i in range(4):
        j = (i + 1) % 4
        shape.quads(material, outer[i], outer[j], inner[j], inner[i])
        shape.quads("concrete", inner[i], inner[j], deep[j], deep[i])
    shape.quads("glass", *deep)


def house(random: np.random.Generator, width: float, depth: float) -> Shape:
    """With its lowest corner at the origin."""
    shape, floors = Shape(), int(random.integers(2, 7))
    material = str(random.choice(["plaster", "brick", "concrete"]))
    height = 3.2 * floors
    corners = np.array([[0, 0, 0], [width, 0, 0], [width, depth, 0], [0, depth, 0]], np.float64)
    for i in range(4):
        side: Floats = corners[(i + 1) % 4] - corners[i]
        length = float(np.linalg.norm(side))
        wall(shape, material, corners[i], side / length, length, floors, max(1, round(length / 2.7)))
    top = corners + [0, 0, height]
    if random.random() < 0.5:  # a gable roof
        ridge = np.array([[0, depth / 2, height + depth / 3], [width, depth / 2, height + depth / 3]])
        shape.quads("roof", top[0], top[1], ridge[1], ridge[0])
        shape.quads("roof", top[2], top[3], ridge[0], ridge[1])
        shape.add(material, [[top[1], top[2], ridge[1]], [top[3], top[0], ridge[0]]])
        shape.box("brick", [width * 0.3, depth * 0.4, height], [width * 0.3 + 0.8, depth * 0.4 + 0.8, height + depth / 3 + 1])
    else:  # a flat one with machines
        shape.quads("roof", *top)
        for _ in range(3):
            x, y = random.uniform(1, width - 3), random.uniform(1, depth - 3)
            shape.box("concrete", [x, y, height], [x + 1.6, y + 1.6, height + 1.3])
    return shape


def tree(random: np.random.Generator) -> Shape:
    shape, height = Shape(), random.uniform(2.2, 3.2)
    shape.cylinder("bark", (0, 0, 0), (0, 0, height + 1), 0.18)
    for _ in range(7):
        center = random.normal(0, (0.9, 0.9, 0.6)) + (0, 0, height + 1.6)
        shape.cylinder("bark", (0, 0, height * 0.8), center, 0.06, 5)
        shape.ball("leaves", center, random.uniform(0.7, 1.3, 3), 6, 9, 0.25, random)
    return shape


def car(paint: str) -> Shape:
    """4.4 m long, towards +x."""
    shape = Shape()
    profile = np.array([(-2.2, 0.35), (2.2, 0.35), (2.2, 0.75), (0.95, 0.95), (0.35, 1.45), (-1.2, 1.48), (-1.9, 0.98), (-2.2, 0.9)])
    left, right = (np.column_stack([profile[:, 0], np.full(8, side), profile[:, 1]]) for side in (0.86, -0.86))
    for i in range(8):
        j = (i + 1) % 8
        shape.quads("glass" if i in (3, 5) else paint, right[i], left[i], left[j], right[j])
    middle = left.mean(0), right.mean(0)
    shape.add(paint, [[middle[0], left[(i + 1) % 8], left[i]] for i in range(8)])
    shape.add(paint, [[middle[1], right[i], right[(i + 1) % 8]] for i in range(8)])
    for side in (0.87, -0.87):
        shape.quads("glass", *(np.array([(-1.3, side, 1.0), (0.55, side, 1.0), (0.3, side, 1.4), (-1.1, side, 1.4)])[:: 1 if side < 0 else -1]))
        for x in (-1.35, 1.4):
            shape.cylinder("tyre", (x, side - 0.1, 0.33), (x, side + 0.1, 0.33), 0.33, 20)
        for x in (-2.21, 2.21):
            shape.box("reflector", np.minimum((x, side * 0.8, 0.6), (x, side * 0.7, 0.7)), np.maximum((x, side * 0.8, 0.6), (x, side * 0.7, 0.7)))
    shape.box("white paint", (-2.23, -0.26, 0.42), (-2.21, 0.26, 0.53))
    return shape


def person() -> Shape:
    shape = Shape()
    shape.ball("skin", (0, 0, 1.64), (0.10, 0.09, 0.13), 8, 12)
    shape.ball("cloth", (0, 0, 1.18), (0.15, 0.24, 0.38), 10, 14)
    for side in (0.11, -0.11):
        shape.cylinder("cloth", (0.12 * np.sign(side), side, 0.05), (0, side, 0.95), 0.08, 10)
        shape.cylinder("skin", (-0.15 * np.sign(side), 2.3 * side, 0.85), (0, 2.1 * side, 1.42), 0.05, 8)
        shape.box("tyre", (0.12 * np.sign(side) - 0.1, side - 0.05, 0), (0.12 * np.sign(side) + 0.16, side + 0.05, 0.08))
    return shape


class Town:
    """blocks: along each side. cars, people: how many move. seed: of everything that is drawn."""

    def __init__(self, blocks: int = 6, cars: int = 60, people: int = 120, seed: int = 1) -> None:
        random = np.random.default_rng(seed)
        self.extent = blocks * PITCH
        self.trees = [tree(random) for _ in range(8)]
        self.ground = self._ground(random, blocks)
        self.shapes = [car("red paint"), car("blue paint"), car("white paint"), person()]
        self.which = np.concatenate([random.integers(0, 3, cars), np.full(people, 3)])
        walks = self.which == 3
        count = cars + people
        # Each moves along a street, on its right: towards +-x (axis 0) or +-y (axis 1).
        self._axis, self._sign = random.integers(0, 2, count), random.choice([-1, 1], count)
        side = np.where(walks, STREET / 2 - 1.2, 2.6)
        self._lane = random.integers(0, blocks + 1, count) * PITCH - STREET / 2 + np.where(self._axis == 0, -1, 1) * self._sign * side
        self._start = random.uniform(0, self.extent, count)
        self._speed = np.where(walks, random.uniform(0.8, 1.8, count), random.uniform(6, 14, count))

    def _ground(self, random: np.random.Generator, blocks: int) -> Shape:
        shape, end = Shape(), blocks * PITCH
        edges = np.linspace(-STREET, end, 8 * blocks + 1)
        x, y = (a[..., None] for a in np.meshgrid(edges, edges, indexing="ij"))
        flat = np.concatenate([x, y, 0 * x], -1)
        shape.quads("asphalt", flat[:-1, :-1], flat[1:, :-1], flat[1:, 1:], flat[:-1, 1:])
        for i in range(blocks + 1):  # the lines between the lanes
            middle, at = i * PITCH - STREET / 2, np.arange(0, end, 6.0)[:, None]
            dash = [np.concatenate(np.broadcast_arrays(at + x, middle + y, 0.01), 1) for x, y in ((0, -0.08), (3, -0.08), (3, 0.08), (0, 0.08))]
            shape.quads("marking", *dash)
            shape.quads("marking", *(corner[:, [1, 0, 2]] for corner in dash[::-1]))
        for i in range(blocks):
            for j in range(blocks):
                shape.join(self._block(random).moved((i * PITCH, j * PITCH, 0)))
        return shape

    def _block(self, random: np.random.Generator) -> Shape:
        shape = Shape()
        shape.box("pavement", (0, 0, 0), (BLOCK, BLOCK, 0.15))
        shape.box("grass", (16, 16, 0.15), (BLOCK - 16, BLOCK - 16, 0.2))
        for k in range(4):  # houses along each side, a garden in the middle
            turn, corner = k * np.pi / 2, [(3, 3), (BLOCK - 3, 3), (BLOCK - 3, BLOCK - 3), (3, BLOCK - 3)][k]
            x = 0.0
            while x < BLOCK - 24:
                width = float(random.uniform(9, 15))
                if random.random() < 0.9:
                    place = np.array([*corner, 0.15]) + x * np.array([np.cos(turn), np.sin(turn), 0])
                    shape.join(house(random, min(width, BLOCK - 18 - x), 11.0).moved(place, turn))
                x += width + 0.6
        for place in [*random.uniform(18, BLOCK - 18, (5, 2)), *((x, y) for x in (1.2, BLOCK - 1.2) for y in (12, 31, 50)),
                      *((x, y) for x in (22, 42) for y in (1.2, BLOCK - 1.2))]:
            shape.join(self.trees[random.integers(8)].moved((*place, 0.15), random.uniform(0, 6.28)))
        for x in (0.6, BLOCK - 0.6):  # lamp posts
            shape.cylinder("concrete", (x, 0.6, 0.15), (x, 0.6, 6.5), 0.06, 8)
            shape.box("concrete", (x - 0.2, 0.1, 6.4), (x + 0.2, 1.1, 6.5))
        return shape

    def motion(self, seconds: float, duration: float = 0.0) -> tuple[Floats, Floats]:
        """Where cars and people are at a time and `duration` later: (N, 3, 4) each, from their coordinates to those of the
        town. Who reaches the end of its street begins again, but never between the two."""
        along = (self._start + self._speed * seconds) % self.extent
        return self._placed(along), self._placed(along + self._speed * duration)

    def _placed(self, along: Floats) -> Floats:
        place = np.where(self._sign > 0, along, self.extent - along)
        cosine, sine = np.where(self._axis == 0, self._sign, 0), np.where(self._axis == 1, self._sign, 0)
        rows = np.zeros((len(along), 3, 4))
        rows[:, 0, 0], rows[:, 0, 1], rows[:, 1, 0], rows[:, 1, 1], rows[:, 2, 2] = cosine, -sine, sine, cosine, 1
        rows[:, 0, 3], rows[:, 1, 3] = np.where(self._axis == 0, place, self._lane), np.where(self._axis == 0, self._lane, place)
        rows[:, 2, 3] = np.where(self.which == 3, 0.15, 0.0)
        return rows

    def scene(self) -> claray.Scene:
        scene = claray.Scene()
        scene.name = "town"
        for name, color, _ in MATERIALS:
            scene.add_material(albedo=color, name=name)
        for shape in (self.ground, *self.shapes):
            vertices, triangles, materials = shape.arrays()
            scene.add_mesh(vertices, triangles, material=materials)
        rows = np.concatenate([np.eye(4)[None, :3], self.motion(0.0)[0]])
        scene.set_instances(np.concatenate([[0], 1 + self.which]), rows)
        return scene

    @property
    def movers(self) -> NDArray[np.uint32]:
        return np.arange(1, 1 + len(self.which), dtype=np.uint32)
