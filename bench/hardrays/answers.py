"""The right answers of rays and points, by exact arithmetic over all triangles that may count. README.md has the rules."""

import numpy as np

from exact import U, as_integers, broken_signs, certainly_misses, cross, distances, dot, quotients, side_signs, sign
from shapes import weld

MISS, HIT, EITHER = 0, 1, 2
UNKNOWN = -1
ULP = 2.0 ** -23
MOST_PAIRS = 1 << 22


def valid_triangles(positions, triangles):
    """Those whose positions are finite."""
    return np.flatnonzero(np.isfinite(positions[triangles]).all(axis=(1, 2)))


def near_pairs(corners, origins, directions):
    """Rays and triangles whose bounding spheres the lines meet. Rounding only adds pairs."""
    middle = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1)))
    v, o = corners - middle, origins - middle
    c = v.mean(axis=1)
    reach = ((v - c[:, None]) ** 2).sum(axis=2).max(axis=1)
    d = directions / abs(directions).max(axis=1)[:, None]
    d /= np.sqrt(dot(d, d))[:, None]
    c_squares, o_squares = dot(c, c), dot(o, o)
    step = max(1, MOST_PAIRS // len(c))
    for first in range(0, len(o), step):
        rows = slice(first, first + step)
        along = d[rows] @ c.T - dot(d[rows], o[rows])[:, None]
        squares = c_squares - 2 * (o[rows] @ c.T) + o_squares[rows, None]
        slack = 256 * U * (c_squares + o_squares[rows, None])
        ray, triangle = np.nonzero((squares - along * along <= 1.0001 * reach + slack) & (along >= -np.sqrt(1.0001 * reach + slack)))
        for part in range(0, len(ray), MOST_PAIRS // 8):
            r, t = ray[part:part + MOST_PAIRS // 8] + first, triangle[part:part + MOST_PAIRS // 8]
            keep = ~certainly_misses(origins[r], directions[r], corners[t])
            yield r[keep], t[keep]


class Links:
    """What meets at the edges opposite to the corners of triangles, and at the corners: numbers of triangles, and borders."""

    def __init__(self, triangles):
        count = int(triangles.max()) + 1
        edges = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].astype(np.int64), axis=2)
        self.corners = triangles
        self.edges = edges[..., 0] * count + edges[..., 1]
        _, number, counts = np.unique(self.edges, return_inverse=True, return_counts=True)
        self.edge_counts = counts[number.reshape(self.edges.shape)]
        self.corner_counts = np.bincount(triangles.ravel())[triangles]
        self.edge_at_border = self.edge_counts % 2 == 1
        at_border = np.zeros(count, bool)
        at_border[edges[self.edge_at_border].ravel()] = True
        self.corner_at_border = at_border[triangles]


class Touches:
    """All pairs of a ray and a triangle that have a point in common, each with its place on the ray."""

    def __init__(self, ray, triangle, origins, directions, corners):
        o, d, v = origins[ray], directions[ray], corners[triangle]
        signs = side_signs(o, d, v)
        self.flat_ray, self.flat = ray[(signs == 0).all(axis=1)], triangle[(signs == 0).all(axis=1)]
        keep = ((signs >= 0).all(axis=1) | (signs <= 0).all(axis=1)) & (signs != 0).any(axis=1)
        ray, triangle, signs, o, d, v = ray[keep], triangle[keep], signs[keep], o[keep], d[keep], v[keep]
        above, below = distances(o, d, v)
        ahead = np.array([a > 0 for a in above], bool)
        if any(a == 0 for a in above):
            raise ValueError("a ray starts on a triangle")
        self.ray, self.triangle, self.signs = ray[ahead], triangle[ahead], signs[ahead]
        self.above, self.below = above[ahead], below[ahead]
        self.t = quotients(self.above, self.below)
        self.broken = broken_signs(o[ahead], d[ahead], v[ahead], self.signs)
        order = np.lexsort((self.triangle, self.t, self.ray))
        for name in ("ray", "triangle", "signs", "above", "below", "t", "broken"):
            setattr(self, name, getattr(self, name)[order])
        begins = self._are_begins()
        self.begins, self.group = np.flatnonzero(begins), np.cumsum(begins) - 1

    def _are_begins(self):
        """Whether a touch lies at another point than the one before."""
        same = np.zeros(len(self.ray), bool)
        same[1:] = (self.ray[1:] == self.ray[:-1]) & (self.t[1:] == self.t[:-1])
        rows = np.flatnonzero(same)
        differ = self.above[rows] * self.below[rows - 1] != self.above[rows - 1] * self.below[rows]
        if differ.any():
            raise ValueError("two distances have the same float64")
        return ~same


def fans_of(touches, links):
    """The touches of a group at one edge or at one corner are a fan. For each touch: its fan's number, and whether all triangles
    that meet there are in it and none is at a border. A touch away from edges is a fan."""
    rows, zeros = np.arange(len(touches.triangle)), (touches.signs == 0).sum(axis=1)
    on_edge = touches.triangle, np.argmax(touches.signs == 0, axis=1)
    on_corner = touches.triangle, np.argmax(touches.signs != 0, axis=1)
    choose = lambda edges, corners: np.where(zeros == 1, edges[on_edge], corners[on_corner])
    name = choose(links.edges, links.corners) * 4 + zeros
    _, fan = np.unique(np.stack([touches.group, np.where(zeros == 0, -1 - rows, name)]), axis=1, return_inverse=True)
    fan = fan.ravel()
    complete = np.bincount(fan)[fan] == choose(links.edge_counts, links.corner_counts)
    return fan, (zeros == 0) | (complete & ~choose(links.edge_at_border, links.corner_at_border))


def sides(touches, links):
    """For each group of touches at one point: whether the ray must hit there, whether the number of crossings is certain, and it."""
    group, count = touches.group, int(touches.group[-1]) + 1 if len(touches.group) else 0
    fan, whole = fans_of(touches, links)
    turns = np.bincount(fan, touches.signs.sum(axis=1) > 0)[fan]
    one_side = (turns == 0) | (turns == np.bincount(fan)[fan])
    crossed = (touches.broken > 0).all(axis=1) | (touches.broken < 0).all(axis=1)
    odd_fan = np.bincount(fan, crossed)[fan] % 2 == 1
    must = np.bincount(group, whole & (one_side | odd_fan), count) > 0
    certain = np.bincount(group, whole & one_side, count) == np.bincount(group, minlength=count)
    return must, certain, np.bincount(group, crossed, count).astype(np.int64)


def flat_ranges(rays, triangles, origins, directions, corners):
    """Rays in the planes of triangles: pairs that meet, and the range of the ray within the triangle (at most too long)."""
    if not len(rays):
        return np.zeros(0, bool), np.zeros(0), np.zeros(0)
    (o, d, v), _ = as_integers(origins[rays], directions[rays], corners[triangles])
    normal = cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0])
    side = np.stack([sign(dot(cross(v[:, k] - o, d), normal)) for k in range(3)], axis=1)
    size = dot(d, d)
    along = np.stack([quotients(dot(v[:, k] - o, d), size) for k in range(3)], axis=1)
    meets = ~((side > 0).all(axis=1) | (side < 0).all(axis=1)) & (along.max(axis=1) >= 0)
    return meets, np.maximum(along.min(axis=1), 0), along.max(axis=1)


def tolerances(o, d, v, t):
    """How far a distance may be off: by what moves of all positions by 4 ulp of the largest coordinate explain."""
    length = np.sqrt(dot(d / abs(d).max(axis=1)[:, None], d / abs(d).max(axis=1)[:, None])) * abs(d).max(axis=1)
    largest = np.maximum(np.maximum(abs(o).max(axis=1), abs(v).max(axis=(1, 2))), abs(d).max(axis=1) * t)
    move = 4 * ULP * largest
    normal = cross(v[:, 1] - v[:, 0], v[:, 2] - v[:, 0])
    area = np.sqrt(dot(normal, normal))
    longest = np.sqrt(np.max([dot(v[:, k] - v[:, k - 1], v[:, k] - v[:, k - 1]) for k in range(3)], axis=0))
    towards = d / length[:, None]
    slope = abs(dot(normal, towards)) / area
    extent = np.max([abs(dot(v[:, k] - o, towards) - t * length) for k in range(3)], axis=0)
    flat = area / longest < 16 * move
    with np.errstate(divide="ignore", invalid="ignore"):  # triangles without area
        return (np.where(flat, extent, np.minimum(move / slope, extent)) + move) / length


def answers_of_rays(positions, triangles, origins, directions, pairs=None):
    """The arrays of answers of a case. pairs: candidates, where fewer than all of them are known to count."""
    usable = valid_triangles(positions, triangles)
    mesh = triangles[usable]
    corners, o, d = positions.astype(np.float64)[mesh], origins.astype(np.float64), directions.astype(np.float64)
    found = pairs if pairs is not None else [np.concatenate(a) for a in zip(*near_pairs(corners, o, d))]
    touches = Touches(*found, o, d, corners)
    links = Links(weld(positions, mesh)[1])
    must, certain, crossings = sides(touches, links)
    flat = flat_ranges(touches.flat_ray, touches.flat, o, d, corners)
    closed = not links.edge_at_border.any()
    out = collect(touches, must, flat, len(o))
    out.update(counts_of(touches, certain, crossings, flat[0], closed, len(o)))
    ray, triangle = out.pop("ray"), out["primitive"]
    slack = tolerances(o[ray], d[ray], corners[triangle], out["t"])
    out["tolerance"] = np.maximum(slack, out.pop("half"))
    out["primitive"] = usable[triangle].astype(np.uint32)
    return out


def collect(touches, must, flat, count):
    """The accepted answers of each ray: all points up to the first one where the ray must hit."""
    first = np.full(count, np.inf)
    hits = touches.begins[must]
    first_rays, index = np.unique(touches.ray[hits], return_index=True)
    first[first_rays] = touches.t[hits[index]]
    meets, low, high = flat
    flat_ray, flat_triangle = touches.flat_ray[meets], touches.flat[meets]
    low, high = low[meets], np.minimum(high[meets], first[flat_ray])
    keep, keep_flat = touches.t <= first[touches.ray], low <= first[flat_ray]
    ray = np.concatenate([touches.ray[keep], flat_ray[keep_flat]])
    t = np.concatenate([touches.t[keep], 0.5 * (low + high)[keep_flat]])
    half = np.concatenate([np.zeros(keep.sum()), 0.5 * (high - low)[keep_flat]])
    triangle = np.concatenate([touches.triangle[keep], flat_triangle[keep_flat]])
    order = np.lexsort((triangle, t, ray))
    per_ray = np.bincount(ray, minlength=count)
    expect = np.where(np.isfinite(first), HIT, np.where(per_ray > 0, EITHER, MISS)).astype(np.uint8)
    return {"expect": expect, "first": np.concatenate([[0], np.cumsum(per_ray)]).astype(np.uint32), "ray": ray[order],
            "primitive": triangle[order], "t": t[order], "half": half[order]}


def counts_of(touches, certain, crossings, meets, closed, count):
    """Crossings of each ray where they are certain, and their parity in a closed mesh."""
    owner = touches.ray[touches.begins]
    flat = np.bincount(touches.flat_ray[meets], minlength=count) > 0
    doubtful = (np.bincount(owner, ~certain, count) > 0) | flat
    total = np.bincount(owner, crossings, count).astype(np.int32)
    parity = np.where(flat | (not closed), UNKNOWN, total % 2).astype(np.int8)
    return {"count": np.where(doubtful, UNKNOWN, total).astype(np.int32), "parity": parity}
