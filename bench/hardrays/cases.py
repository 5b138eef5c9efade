"""The twenty cases: meshes, rays and points. Each function returns the arrays of one file."""

import numpy as np

from answers import EITHER, HIT, MISS, answers_of_rays
from exact import dot
from nearest import answers_of_points
from shapes import (Numbers, ball, box, fan, grid, join, normals_of, octahedron, points_of, unit)


def rays_case(mesh, origins, directions, pairs=None, closed=True):
    positions, triangles = mesh
    if closed:
        check_closed(triangles)
    origins, directions = origins.astype(np.float32), directions.astype(np.float32)
    answers = answers_of_rays(positions, triangles, origins, directions, pairs)
    return {"positions": positions, "triangles": triangles, "origins": origins, "directions": directions, **answers}


def check_closed(triangles):
    """Every edge has two triangles, which pass it in opposite directions."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    there, back = (e[:, 0] * (1 << 32) + e[:, 1] for e in (edges, edges[:, ::-1]))
    if len(np.unique(there)) != len(there) or not np.array_equal(np.sort(there), np.sort(back)):
        raise ValueError("the mesh is not closed")


def aimed(origins, targets, length=1.0):
    """Directions of float32 from the rounded origins to the targets."""
    origins = origins.astype(np.float32)
    return origins, (unit(targets - origins) * length).astype(np.float32)


def around(triangles, chosen):
    """Pairs of a ray and a triangle that shares a vertex with the ray's chosen triangle."""
    count = int(triangles.max()) + 1
    order = np.argsort(triangles.ravel(), kind="stable")
    first = np.searchsorted(triangles.ravel()[order], np.arange(count + 1))
    ray, vertex = np.repeat(np.arange(len(chosen)), 3), triangles[chosen].ravel()
    size = (first[1:] - first[:-1])[vertex]
    index = np.arange(size.sum()) - np.repeat(np.cumsum(size) - size, size)
    ray, triangle = np.repeat(ray, size), order[np.repeat(first[vertex], size) + index] // 3
    pairs = np.unique(ray * len(triangles) + triangle)
    return pairs // len(triangles), pairs % len(triangles)


def from_inside(mesh, kinds, numbers, count, center=(0, 0, 0), radius=0.5):
    """Rays of a convex mesh that start within a ball around its center."""
    origins = numbers.directions(count) * radius * numbers.between(0.02, 1, (count, 1)) + np.array(center)
    targets, chosen = points_of(mesh, kinds, numbers, count)
    case = rays_case(mesh, *aimed(origins, targets), around(mesh[1], chosen))
    if not ((case["expect"] == HIT).all() and (case["count"] == 1).all()):
        raise ValueError("a ray does not certainly leave the convex mesh")
    return case


def convex(kind, seed, count=200_000):
    return lambda: from_inside(ball(5), [kind], Numbers(seed), count)


def offset_100_000():
    center = (148376, 1234, -223423)
    return from_inside(ball(3, 256, center), ["edge", "vertex"], Numbers(4), 60_000, center, 100)


def offset_1_000_000():
    center = (1e6, -1e6, 1e6)
    return from_inside(ball(3, 1024, center), ["edge", "vertex"], Numbers(5), 60_000, center, 400)


def fans():
    """Rays within double cones of 1,024 thin triangles, to the tips, the edges that end there, and the faces."""
    numbers, count, slices = Numbers(6), 6_000, 512
    mesh = fan(slices)
    origins = numbers.between(-0.25, 0.25, (count, 3))
    targets, _ = points_of(mesh, ["edge", "face"], numbers, count)
    targets[::3] = mesh[0][slices + numbers.integers(2, len(targets[::3]))]
    return rays_case(mesh, *aimed(origins, targets))


def slivers():
    """A bed of triangles a thousand times as long as wide, seen from above, away from its border."""
    numbers, count, width = Numbers(7), 10_000, 2.0 ** -10
    positions, triangles = grid(numbers.integers(256, (601, 5)) * width / 256)
    positions *= np.array([width, 1, 1], np.float32)
    corners = positions[triangles]
    inner = (corners[..., 0].min(1) > 0.04) & (corners[..., 0].max(1) < 0.54) & (corners[..., 1].min(1) > 0) & (corners[..., 1].max(1) < 4)
    targets, _ = points_of((positions, triangles[inner]), ["face", "edge", "vertex"], numbers, count)
    away = np.concatenate([numbers.between(-0.01, 0.01, (count, 2)), numbers.between(0.5, 2, (count, 1))], axis=1)
    return rays_case((positions, triangles), *aimed(targets + away, targets), closed=False)


def stadium():
    """A ball of 2^-10 in a box of 2^13: rays aim at the ball's faces, edges and vertices, from outside and from within."""
    numbers, count, center, radius = Numbers(8), 20_000, np.array([1.0, 2.0, 3.0]), 2.0 ** -10
    small = ball(3, radius, center)
    targets, chosen = points_of(small, ["edge", "vertex", "face"], numbers, count)
    away = unit(normals_of(small)[chosen] + 0.3 * numbers.directions(count))
    origins = targets + away * radius * 4.0 ** numbers.integers(9, (count, 1))
    inside = np.arange(count) % 4 == 0
    origins[inside] = center + 0.3 * radius * numbers.directions(count)[inside]
    origins, directions = aimed(origins, targets)
    keep = inside | clear_of(origins, directions, center, radius)
    return rays_case(join(box(8, 8192.0), small), origins[keep], directions[keep])


def clear_of(origins, directions, center, radius):
    """Rays that pass by the outline of a ball at a tenth of its radius or more."""
    o, d = origins.astype(np.float64) - center, unit(directions.astype(np.float64))
    distance = np.sqrt(dot(o, o) - dot(o, d) ** 2)
    return abs(distance - radius) > 0.1 * radius


def planes():
    """Rays within the planes of square panels, on them or beside them, to the walls of a room."""
    numbers, count = Numbers(9), 20_000
    panels = [panel(k % 3, k - 4.0, 5 * (k // 3) - 6.0, 4 * (k % 3) - 5.0) for k in range(9)]
    chosen = numbers.integers(9, count)
    rows, normal = np.arange(count), chosen % 3
    origins = (numbers.integers(229, (count, 3)) - 114) / 16.0 + 1 / 64  # off the edges of panels
    directions = numbers.integers(17, (count, 3)) - 8.0
    directions[rows, (normal + 1) % 3] += directions[rows, (normal + 1) % 3] == 0
    origins[rows, normal], directions[rows, normal] = chosen - 4.0, 0.0
    return rays_case(join(box(16, 16.0), *panels), origins, directions, closed=False)


def panel(normal, level, x, y):
    """Eight triangles of a square across an axis."""
    positions, triangles = grid(np.full((3, 3), level), 1.0, (x, y))
    return np.ascontiguousarray(np.roll(positions, normal + 1, axis=1)), triangles


def axis():
    """Axis-parallel rays, with zeros of both signs, among octahedra; they start in planes of bounding boxes. Below is a slab."""
    numbers, count = Numbers(10), 20_000
    places = np.stack(np.meshgrid(*3 * [np.arange(5) * 4.0 - 8]), axis=-1).reshape(-1, 3)
    mesh = join(*[octahedron(p, 1.0) for p in places], box(8, np.array([32.0, 32.0, 1.0]), (0, 0, -11.5)))
    along = numbers.integers(3, count)
    directions = np.where(numbers.integers(2, (count, 3)) == 1, 0.0, -0.0)
    directions[np.arange(count), along] = numbers.integers(2, count) * 2 - 1.0
    origins = numbers.integers(21, (count, 3)) - 10.0  # the bounding boxes end at odd integers
    fine = numbers.integers(2, (count, 1)) == 1
    origins = np.where(fine & (np.arange(3) != along[:, None]), origins + (1 + numbers.integers(63, (count, 3))) / 64, origins)
    origins, keep = off_surface(origins, places, 1.0)
    return rays_case(mesh, origins, directions[keep])


def off_surface(origins, places, radius):
    """The origins that lie on no octahedron."""
    size = abs(origins[:, None] - places).sum(axis=2)
    keep = (size != radius).all(axis=1)
    return origins[keep], keep


def duplicates():
    """A ball of whose triangles each is there four times, in random order and with the corners turned."""
    numbers, count = Numbers(11), 20_000
    positions, triangles = ball(2)
    copies = np.concatenate([np.roll(triangles, k % 3, axis=1) for k in range(4)])
    mesh = positions, np.ascontiguousarray(copies[numbers.order(len(copies))])
    targets, _ = points_of(mesh, ["face", "edge", "vertex"], numbers, count)
    origins = unit(targets) * numbers.between(2, 4, (count, 1)) + 0.3 * numbers.directions(count)
    inside = np.arange(count) % 2 == 0
    origins[inside] = 0.4 * numbers.directions(count)[inside]
    return without_counts(rays_case(mesh, *aimed(origins, targets), closed=False))  # copies count once or four times


def without_counts(case):
    return {name: values for name, values in case.items() if name not in ("count", "parity")}


def scaled(power, seed):
    """Two balls, one within the other, and rays from outside and from between, times a power of two."""
    def case():
        numbers, count, scale = Numbers(seed), 20_000, 2.0 ** power
        mesh = join(ball(3), ball(3, 2.0))
        targets, chosen = points_of(mesh, ["face", "edge", "vertex"], numbers, count)
        origins = targets + unit(normals_of(mesh)[chosen] + 0.2 * numbers.directions(count)) * numbers.between(0.25, 0.75, (count, 1))
        o, d = aimed(origins, targets)
        return rays_case((mesh[0] * np.float32(scale), mesh[1]), o * np.float32(scale), d)
    return case


def lattice():
    """Three closed boxes with vertices at integers; rays pass through vertices and middles of edges, exactly."""
    numbers, count = Numbers(14), 20_000
    mesh = join(box(4, 8.0), box(8, 16.0), box(16, 64.0))
    targets = np.where(np.arange(count)[:, None] % 2 == 0, exact_middles(mesh, numbers, count), points_of(mesh, ["vertex"], numbers, count)[0])
    origins = numbers.integers(29, (count, 3)) * 2 - 28.0 + 0.5
    return rays_case(mesh, origins, (targets - origins) * 2)


def exact_middles(mesh, numbers, count):
    v = mesh[0].astype(np.float64)[mesh[1]][numbers.integers(len(mesh[1]), count)]
    return 0.5 * (v[:, 0] + v[:, 1])


def far_origins():
    """A box of 16 units, seen from a million. Half of the rays pass through vertices and middles of edges, exactly."""
    numbers, count = Numbers(15), 20_000
    mesh = box(8, 16.0)
    targets = np.where(np.arange(count)[:, None] % 2 == 0, exact_middles(mesh, numbers, count), points_of(mesh, ["vertex"], numbers, count)[0])
    outer = abs(targets)
    face = np.argmax(outer, axis=1)
    keep = np.sort(outer, axis=1)[:, 1] <= 6
    rows = np.arange(count)
    origins = np.floor(numbers.between(-2 ** 18, 2 ** 18, (count, 3)))
    origins[rows, face] = np.sign(targets[rows, face]) * (2 ** 19 + numbers.integers(2 ** 18, count))
    exact = numbers.integers(2, (count, 1)) == 1
    near, towards = aimed(origins, targets)
    directions = np.where(exact, targets - origins, towards)
    return rays_case(mesh, near[keep], directions[keep])


def limits():
    """Rays down on hills of integer heights. They end, or begin, at the hit, or a little before or behind it."""
    numbers, count = Numbers(16), 20_000
    mesh = grid(numbers.integers(4, (33, 33)) * 1.0)
    flat = np.floor(numbers.between(2, 30, (count, 2))) + (1 + numbers.integers(63, (count, 2))) / 64.0
    origins = np.concatenate([flat, 8.0 + 8 * numbers.integers(4, (count, 1))], axis=1)
    directions = np.concatenate([numbers.integers(5, (count, 2)) / 64.0 - 2 / 64.0, np.full((count, 1), -1.0)], axis=1)
    case = rays_case(mesh, origins, directions, closed=False)
    return limited(case, numbers)


def limited(case, numbers):
    """Adds tmax or tmin: at the float32 next to the first hit, or 2^-14 of the distance before or behind it."""
    count = len(case["origins"])
    t = case["t"][case["first"][:-1]].astype(np.float32)
    if not (case["expect"] == HIT).all():
        raise ValueError("a ray misses")
    kind, step = numbers.integers(6, count), 2.0 ** -14
    at = t * (1 + np.array([0, step, -step, 0, -step, step], np.float32)[kind])
    tmin = np.where(kind >= 3, at, np.float32(0))
    tmax = np.where(kind < 3, at, np.float32(np.inf))
    case["expect"] = np.where((kind == 0) | (kind == 3), EITHER, np.where((kind == 2) | (kind == 5), MISS, HIT)).astype(np.uint8)
    case["tmin"], case["tmax"] = tmin.astype(np.float32), tmax.astype(np.float32)
    return without_counts(case)


def junk():
    """A ball, and among its triangles some with NaN or infinite vertices, and some without area."""
    numbers, count = Numbers(17), 20_000
    positions, triangles = ball(3)
    bad = np.repeat(numbers.between(-1, 1, (120, 1, 3)), 3, axis=1)  # triangles that are points
    bad[:30, 1] += numbers.between(-0.25, 0.25, (30, 3))              # or lines
    bad[30:60, 0, 0], bad[60:80, 1, 1], bad[80:90, 2, 2] = np.nan, np.inf, -np.inf
    more = np.arange(360, dtype=np.uint32).reshape(-1, 3) + np.uint32(len(positions))
    mixed = np.concatenate([triangles, more])[numbers.order(len(triangles) + len(more))]
    mesh = np.concatenate([positions, bad.reshape(-1, 3).astype(np.float32)]), np.ascontiguousarray(mixed)
    targets, chosen = points_of((positions, triangles), ["face", "edge", "vertex"], numbers, count)
    origins = 0.4 * numbers.directions(count)
    outside = np.arange(count) % 2 == 0
    origins[outside] = (targets + normals_of((positions, triangles))[chosen])[outside]
    return without_counts(rays_case(mesh, *aimed(origins, targets), closed=False))


def lengths():
    """Rays within a ball whose directions have lengths from 1e-20 to 1e20."""
    numbers, count = Numbers(18), 20_000
    mesh = ball(3)
    origins = 0.5 * numbers.directions(count)
    targets, chosen = points_of(mesh, ["face", "edge", "vertex"], numbers, count)
    scale = np.array([1e-20, 1e-10, 1e-5, 1e5, 1e10, 1e20])[numbers.integers(6, (count, 1))]
    return rays_case(mesh, *aimed(origins, targets, scale), around(mesh[1], chosen))


def nearest():
    """Points around a ball: beside its faces, edges and vertices, at its vertices, within it, and a million units away."""
    numbers, count = Numbers(19), 12_000
    mesh = ball(3)
    near, chosen = points_of(mesh, ["face", "edge", "vertex"], numbers, count)
    points = near + normals_of(mesh)[chosen] * numbers.between(-0.25, 0.25, (count, 1))
    points[::5] = (0.4 * numbers.directions(count))[::5]
    points[1::10] = (unit(near) * 1e6 * numbers.between(0.1, 1, (count, 1)))[1::10]
    points[2::10] = mesh[0][numbers.integers(len(mesh[0]), count)][2::10]
    return points_case(mesh, points)


def tetrahedron():
    """Points around the edges and vertices of a tetrahedron, at 2^-10 to 1/4 of its size."""
    numbers, count = Numbers(20), 40_000
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.125, 0.25, 0.5]], np.float32)
    mesh = positions, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.uint32)
    near, _ = points_of(mesh, ["edge", "vertex"], numbers, count)
    away = numbers.directions(count) * 2.0 ** -(2 + numbers.integers(9, (count, 1)))
    case = points_case(mesh, near + away)
    keep = np.sqrt(case["squared_distance"]) > 16 * case["tolerance"]  # signs at the surface are lost by rounding
    return {name: values[keep] if len(values) == len(keep) else values for name, values in case.items()}


def points_case(mesh, points):
    check_closed(mesh[1])
    points = points.astype(np.float32)
    return {"positions": mesh[0], "triangles": mesh[1], "points": points, **answers_of_points(*mesh, points)}


CASES = {
    "convex-faces": convex("face", 1), "convex-edges": convex("edge", 2), "convex-vertices": convex("vertex", 3),
    "offset-1e5": offset_100_000, "offset-1e6": offset_1_000_000, "fans": fans, "slivers": slivers, "stadium": stadium,
    "planes": planes, "axis": axis, "duplicates": duplicates, "tiny": scaled(-20, 12), "huge": scaled(20, 13),
    "lattice": lattice, "far-origins": far_origins, "limits": limits, "junk": junk, "lengths": lengths,
    "nearest": nearest, "tetrahedron": tetrahedron,
}
