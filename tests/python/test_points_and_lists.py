"""Nearest points, insides, all hits and overlaps, against float64 brute force of NumPy and closed forms."""

import warnings

import numpy as np
import pytest

import claray
from test_bad_input import NAN, refused


def nearest_on_triangles(points, a, b, c):
    """Squared distances (N, T) by clamping to the triangle's plane, edges and vertices, in float64."""
    p = points.astype(np.float64)[:, None]

    def to_segment(s, e):
        t = np.clip(((p - s) * (e - s)).sum(-1) / ((e - s) ** 2).sum(-1), 0, 1)
        return ((p - s - t[..., None] * (e - s)) ** 2).sum(-1)

    normal = np.cross(b - a, c - a)
    height = ((p - a) * normal).sum(-1)
    over = np.stack([(np.cross(e - s, p - s) * normal).sum(-1) >= 0 for s, e in ((a, b), (b, c), (c, a))]).all(axis=0)
    edges = np.minimum(np.minimum(to_segment(a, b), to_segment(b, c)), to_segment(c, a))
    return np.where(over, height**2 / (normal**2).sum(-1), edges)


@pytest.fixture(scope="module")
def ball():
    """A closed sphere of radius 1 of 1,280 triangles."""
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.icosphere(subdivisions=3)
    return claray.Bvh(mesh.vertices, mesh.faces)


def test_nearest_points_equal_a_brute_force(soup):
    vertices, triangles, bvh = soup
    points = np.random.default_rng(4).uniform(-1.5, 1.5, (400, 3)).astype(np.float32)
    a, b, c = np.moveaxis(vertices.astype(np.float64)[triangles], 1, 0)
    squares = nearest_on_triangles(points, a, b, c)
    found = claray.nearest_point(bvh, points)
    np.testing.assert_allclose(found["distance"], np.sqrt(squares.min(axis=1)), rtol=1e-7)
    clear = np.partition(squares, 1, axis=1)[:, 1] > squares.min(axis=1) * (1 + 1e-6)  # else the edge of two triangles
    assert clear.sum() > 300 and (found["primitive"][clear] == squares.argmin(axis=1)[clear]).all()
    weights = np.stack([1 - found["u"] - found["v"], found["u"], found["v"]], axis=-1).astype(np.float64)
    corners = np.stack([a, b, c], axis=1)[found["primitive"]]
    np.testing.assert_allclose((weights[..., None] * corners).sum(axis=1), found["point"], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(found["point"] - points, axis=1), found["distance"], atol=1e-6)
    near = claray.nearest_point(bvh, points, reach=0.1)
    out = found["distance"] > 0.1
    assert 50 < out.sum() < 350 and (near["primitive"][out] == claray.MISS).all() and (near[~out] == found[~out]).all()
    assert (near["distance"][out] == np.float32(0.1)).all() and (near["point"][out] == points[out]).all()


def test_masks_and_points_that_are_not_finite(soup):
    vertices, triangles, _ = soup
    bvh = claray.Bvh(vertices, triangles, geometries=np.arange(300) % 2, masks=[1, 2])
    points = np.zeros((3, 3), np.float32)
    for mask in (1, 2):
        found = claray.nearest_point(bvh, points, masks=np.full(3, mask))
        assert (found["geometry"] == mask - 1).all() and (found["primitive"] % 2 == mask - 1).all()
        distance = claray.signed_distance(bvh, points, masks=np.full(3, mask), open="vote")
        assert (np.abs(distance) == found["distance"]).all()
    missed = claray.nearest_point(bvh, NAN, nan="miss")["primitive"] == claray.MISS
    assert missed.tolist() == [False, True, False]
    assert not claray.inside(bvh, NAN, nan="miss", open="vote")[1]


def test_signed_distances_of_a_ball(ball):
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (2000, 3))
    radius = np.linalg.norm(points, axis=1)
    points, radius = points[np.abs(radius - 0.995) > 0.006], radius[np.abs(radius - 0.995) > 0.006]
    inside = claray.inside(ball, points)
    assert (inside == (radius < 0.995)).all() and 100 < inside.sum() < 1900
    distance = claray.signed_distance(ball, points)
    np.testing.assert_allclose(distance, radius - 1, atol=0.02)
    assert (np.abs(distance) == claray.nearest_point(ball, points)["distance"]).all()
    short = claray.signed_distance(ball, points, reach=0.25)
    far = np.abs(distance) > 0.25
    assert (short[far] == np.where(inside, -0.25, 0.25)[far]).all() and (short[~far] == distance[~far]).all()


def test_open_meshes_are_told_of(ball):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.icosphere(subdivisions=3)
    bowl = claray.Bvh(mesh.vertices, mesh.faces[mesh.triangles_center[:, 2] < 0.8])
    assert ball.is_closed and not bowl.is_closed
    points = [[0, 0, 0], [0, 0, 3]]
    for query in (claray.inside, claray.signed_distance):
        with pytest.warns(UserWarning, match="^bvh: the mesh is not closed.*open='vote'") as caught:
            by_one_ray = query(bowl, points)
        assert caught[0].filename == __file__
        refused("bvh", lambda: query(bowl, points, open="raise"), "not closed.*vote")
        refused("open", lambda: query(bowl, points, open="ignore"), "warn, raise, vote")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            by_vote = query(bowl, points, open="vote")
            for open in ("raise", "warn", "vote"):
                assert (query(ball, points, open=open) == query(ball, points)).all()
        if query is claray.inside:
            assert by_one_ray.tolist() == [False, False] and by_vote.tolist() == [True, False]
        else:
            assert by_one_ray[0] > 0 > by_vote[0] == -by_one_ray[0] and by_vote[1] == by_one_ray[1] > 0
    ball.refit(np.asarray(mesh.vertices) * 2)
    assert ball.is_closed
    ball.refit(mesh.vertices)


def test_gentle_terrain_contains_nothing_by_vote():
    n = 9
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.random.default_rng(0).uniform(0, 0.2, n * n)])
    corner = (x[:-1, :-1] * n + y[:-1, :-1]).ravel()
    bvh = claray.Bvh(vertices, np.concatenate([np.column_stack([corner, corner + n, corner + n + 1]),
                                               np.column_stack([corner, corner + n + 1, corner + 1])]))
    assert not bvh.is_closed
    points = np.random.default_rng(1).uniform([0, 0, -2], [8, 8, -0.2], (500, 3))
    with pytest.warns(UserWarning, match="not closed"):
        assert claray.inside(bvh, points).sum() > 400  # by one ray, which goes upwards
    assert not claray.inside(bvh, points, open="vote").any()
    assert (claray.signed_distance(bvh, points, open="vote") > 0).all()


def test_closed_lists_hold_all_that_a_ray_touches():
    square = claray.Bvh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    places = [[0.5, 0.5, 1], [0, 0, 1], [1, 0, 1], [0.5, 0, 1], [0.7, 0.2, 1], [2, 0, 1]]
    counts = [2, 2, 1, 1, 1, 0]
    assert claray.count_hits(square, places, (0, 0, -1), closed=True).tolist() == counts
    assert claray.all_hits(square, places, (0, 0, -1), closed=True).counts.tolist() == counts
    nearest = claray.nearest_hits(square, places, (0, 0, -1), most=2, closed=True)
    assert (nearest["primitive"] != claray.MISS).sum(axis=1).tolist() == counts
    assert claray.count_hits(square, places, (0, 0, -1)).max() == 1


def test_all_hits_equal_a_walk_behind_each_hit(soup, rays):
    _, _, bvh = soup
    lists = claray.all_hits(bvh, *rays)
    assert len(lists) == 777 and len(lists.elements) == lists.counts.sum() == lists.offsets[-1]
    assert (lists.counts == claray.count_hits(bvh, *rays)).all() and lists.counts.max() > 4
    start = np.zeros(777, np.float32)
    for k in range(lists.counts.max() + 1):  # each closest hit begins behind the last
        hit = claray.closest_hit(bvh, *rays, tmin=start)
        live = hit["primitive"] != claray.MISS
        assert (live == (lists.counts > k)).all()
        assert (lists.elements[lists.offsets[:-1][live] + k] == hit[live]).all()
        start = np.where(live, hit["t"], start)
    assert (np.bincount(lists.queries, minlength=777) == lists.counts).all()
    assert all((lists[i - 777] == hits).all() and len(hits) == lists.counts[i] for i, hits in enumerate(lists))
    with pytest.raises(IndexError):
        lists[777]


def test_nearest_hits_are_the_first_of_all(soup, rays):
    _, _, bvh = soup
    lists = claray.all_hits(bvh, *rays, tmax=9)
    nearest = claray.nearest_hits(bvh, *rays, most=3, tmax=9)
    assert nearest.shape == (777, 3)
    for row, hits in zip(nearest, lists):
        known = min(3, len(hits))
        assert (row[:known] == hits[:known]).all()
        assert (row["primitive"][known:] == claray.MISS).all() and (row["t"][known:] == 9).all()


def test_counts_of_coincident_surfaces():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    bvh = claray.Bvh(np.concatenate([square] * 3), np.concatenate([[[0, 1, 2], [0, 2, 3]]] * 3) + np.repeat([0, 4, 8], 2)[:, None])
    through = [[0.5, 0.5, 1], [0.3, 0.2, 1]]  # the first along the diagonal that two triangles share
    assert claray.count_hits(bvh, through, (0, 0, -1)).tolist() == [3, 3]
    assert [h["primitive"].tolist() for h in claray.all_hits(bvh, through, (0, 0, -1))][1] == [0, 2, 4]
    assert claray.count_hits(bvh, through, (0, 0, -1), cull_back_faces=True).tolist() == [3, 3]
    assert claray.count_hits(bvh, np.array(through) * [1, 1, -1], (0, 0, 1), cull_back_faces=True).tolist() == [0, 0]


def test_overlaps_equal_a_brute_force(soup):
    vertices, triangles, bvh = soup
    rng = np.random.default_rng(6)
    centers, radii = rng.uniform(-1, 1, (50, 3)).astype(np.float32), rng.uniform(0, 0.4, 50).astype(np.float32)
    a, b, c = np.moveaxis(vertices.astype(np.float64)[triangles], 1, 0)
    touches = nearest_on_triangles(centers, a, b, c) <= radii[:, None].astype(np.float64) ** 2
    lists = claray.sphere_overlaps(bvh, centers, radii)
    assert 100 < len(lists.elements) and lists.elements.dtype == np.uint32
    for i in range(50):
        assert lists[i].tolist() == np.flatnonzero(touches[i]).tolist()
    halves = rng.uniform(0, 0.3, (50, 3)).astype(np.float32)
    boxes = claray.box_overlaps(bvh, centers - halves, centers + halves)
    corner_in = (np.abs(vertices[triangles][None] - centers[:, None, None]) <= halves[:, None, None]).all(-1).any(-1)
    apart = (vertices[triangles].min(1) > (centers + halves)[:, None]) | (vertices[triangles].max(1) < (centers - halves)[:, None])
    for i in range(50):
        assert set(np.flatnonzero(corner_in[i])) <= set(boxes[i]) <= set(np.flatnonzero(~apart[i].any(-1)))
    assert len(boxes.elements) > 100
    assert len(claray.box_overlaps(bvh, [[1, 1, 1]], [[-1, -1, -1]])[0]) == 0
    assert len(claray.sphere_overlaps(bvh, centers, -1.0).elements) == 0
    assert claray.sphere_overlaps(bvh, [[0, 0, 0]], 9)[0].tolist() == list(range(300))


@pytest.mark.filterwarnings("ignore:bvh. the mesh is not closed")
def test_wrong_arguments_are_named(soup, rays):
    _, _, bvh = soup
    origins, directions = rays
    refused("points", lambda: claray.nearest_point(bvh, origins[:, :2]), r"\(777, 2\)")
    refused("points", lambda: claray.nearest_point(bvh, NAN), "row 1")
    refused("points", lambda: claray.inside(bvh, NAN), "row 1")
    refused("points", lambda: claray.signed_distance(bvh, np.full((2, 3), 1e39)), "row 0")
    refused("reach", lambda: claray.nearest_point(bvh, origins, reach=-1), "0 or more")
    refused("reach", lambda: claray.signed_distance(bvh, origins, reach=np.nan))
    refused("reach", lambda: claray.signed_distance(bvh, origins, reach="far"))
    refused("masks", lambda: claray.nearest_point(bvh, origins, masks=[1, 2]), r"\(777,\)")
    refused("out", lambda: claray.nearest_point(bvh, origins, out=np.empty(777, claray.HIT)))
    refused("nan", lambda: claray.nearest_point(bvh, origins, nan="skip"))
    for query in (claray.nearest_point, claray.inside, claray.signed_distance):
        refused("bvh", lambda: query(None, origins), "NoneType")
        assert len(query(bvh, origins[:0])) == 0
    for query in (claray.count_hits, claray.all_hits, lambda *a, **k: claray.nearest_hits(*a, most=2, **k)):
        refused("bvh", lambda: query(None, origins, directions))
        refused("directions", lambda: query(bvh, origins, directions[1:]))
        refused("origins", lambda: query(bvh, NAN, (0, 0, 1)), "row 1")
        refused("rays", lambda: query(bvh, np.array(claray.rays(NAN, (0, 0, 1), nan="miss"))), "row 1")
        refused("tmin", lambda: query(bvh, origins, directions, tmin=-1))
        refused("masks", lambda: query(bvh, origins, directions, masks=[1]))
        refused("filter", lambda: query(bvh, origins, directions, filter="odd"))
        assert len(query(bvh, origins[:0], directions[:0])) == 0
    for most in (0, -1, 1.5, True):
        refused("most", lambda: claray.nearest_hits(bvh, origins, directions, most=most))
    refused("lows", lambda: claray.box_overlaps(bvh, NAN, origins[:3]), "row 1")
    refused("highs", lambda: claray.box_overlaps(bvh, origins, origins[1:]), "776 rows")
    refused("radii", lambda: claray.sphere_overlaps(bvh, origins, [1, 2]))
    refused("radii", lambda: claray.sphere_overlaps(bvh, origins, np.inf))
    assert len(claray.box_overlaps(bvh, origins[:0], origins[:0])) == len(claray.sphere_overlaps(bvh, origins[:0], 1)) == 0
