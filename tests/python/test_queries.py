"""Hits against a float64 brute force of NumPy; arrays of all kinds in and out."""

import gc
import sys
import threading

import numpy as np
import pytest

import claray


def brute_force(vertices, triangles, origins, directions):
    """Distance and triangle of the closest hit by Moeller and Trumbore in float64, and how far it is from an edge."""
    a, b, c = np.moveaxis(vertices.astype(np.float64)[triangles], 1, 0)
    origins, directions = origins.astype(np.float64)[:, None], directions.astype(np.float64)[:, None]
    e1, e2 = b - a, c - a
    p = np.cross(directions, e2)
    det = (e1 * p).sum(-1)
    s = origins - a
    q = np.cross(s, e1)
    u, v, t = (s * p).sum(-1) / det, (directions * q).sum(-1) / det, (e2 * q).sum(-1) / det
    inside = np.minimum(np.minimum(u, v), 1 - u - v)
    distance = np.where((inside > 0) & (t > 0), t, np.inf)
    nearest = distance.argmin(axis=1)
    return distance.min(axis=1), nearest, np.abs(inside).min(axis=1)


def test_closest_hits_equal_a_brute_force(soup, rays):
    vertices, triangles, bvh = soup
    hits = claray.closest_hit(bvh, *rays)
    distance, triangle, margin = brute_force(vertices, triangles, *rays)
    clear = margin > 1e-9  # those that float64 decides
    assert clear.mean() > 0.99
    hit = np.isfinite(distance) & clear
    assert 100 < hit.sum() < 700
    assert (hits["primitive"][hit] == triangle[hit]).all()
    assert (hits["primitive"][~np.isfinite(distance) & clear] == claray.MISS).all()
    np.testing.assert_allclose(hits["t"][hit], distance[hit], rtol=2e-7)
    weights = np.stack([1 - hits["u"] - hits["v"], hits["u"], hits["v"]], axis=-1)[hit].astype(np.float64)
    points = (weights[..., None] * vertices[triangles[triangle[hit]]]).sum(axis=1)
    np.testing.assert_allclose(points, rays[0][hit] + distance[hit, None] * rays[1][hit], atol=1e-5)
    assert np.isinf(hits["t"][hits["primitive"] == claray.MISS]).all()
    assert (claray.any_hit(bvh, *rays) == (hits["primitive"] != claray.MISS)).all()


def test_arrays_of_all_kinds_give_the_same_hits(soup, rays):
    _, _, bvh = soup
    origins, directions = rays
    expected = claray.closest_hit(bvh, origins, directions)
    strided = np.zeros((777, 8), np.float32)
    strided[:, 1:4] = origins
    for given in (origins.astype(np.float64), np.asfortranarray(origins), strided[:, 1:4], origins.tolist(),
                  origins[::-1].copy()[::-1], origins.astype(">f4")):
        assert (claray.closest_hit(bvh, given, directions) == expected).all()
    packed = claray.rays(origins, directions)
    assert packed.dtype == claray.RAY and not packed.flags.writeable
    assert (claray.closest_hit(bvh, packed) == expected).all()
    assert (claray.closest_hit(bvh, packed.view(np.float32).reshape(-1, 8).copy()) == expected).all()
    assert (claray.closest_hit(bvh, np.array(packed)[5:]) == expected[5:]).all()
    out = np.empty(777, claray.HIT)
    assert claray.closest_hit(bvh, packed, out=out) is out and (out == expected).all()
    half = claray.closest_hit(bvh, origins.astype(np.float16), directions.astype(np.float64))
    assert (half == claray.closest_hit(bvh, origins.astype(np.float16).astype(np.float32), directions)).all()


class OnlyDlpack:
    """An array of another library."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


class OnAGpu(OnlyDlpack):
    def __dlpack_device__(self):
        return (2, 0)


def test_dlpack_is_read_in_place(soup, rays):
    _, _, bvh = soup
    expected = claray.closest_hit(bvh, *rays)
    assert (claray.closest_hit(bvh, OnlyDlpack(rays[0]), OnlyDlpack(rays[1])) == expected).all()
    assert (np.from_dlpack(expected["t"]) == expected["t"]).all()
    with pytest.raises(claray.UsageError, match="^origins: .*device memory"):
        claray.closest_hit(bvh, OnAGpu(rays[0]), rays[1])


def test_one_origin_or_direction_for_all(soup, rays):
    _, _, bvh = soup
    eye = np.array([0.0, 0.1, 3.0])
    expected = claray.closest_hit(bvh, np.tile(eye, (777, 1)), rays[1])
    assert (claray.closest_hit(bvh, eye, rays[1]) == expected).all()
    down = claray.any_hit(bvh, rays[0], (0, 0, -1))
    assert (down == claray.any_hit(bvh, rays[0], np.tile([0, 0, -1], (777, 1)))).all()


def test_rays_in_rows_and_columns(soup, rays):
    """As the pixels of an image have them."""
    _, _, bvh = soup
    shape = (37, 21)
    origins, directions = (array.reshape(*shape, 3) for array in rays)
    expected = claray.closest_hit(bvh, *rays).reshape(shape)
    for given in (origins, origins.astype(np.float64), np.asfortranarray(origins), origins.tolist()):
        hits = claray.closest_hit(bvh, given, directions)
        assert hits.shape == shape and (hits == expected).all()
    eye = (0, 0.1, 3)
    assert (claray.closest_hit(bvh, eye, directions).ravel() == claray.closest_hit(bvh, eye, rays[1])).all()
    assert claray.closest_hit(bvh, origins[:, ::2], directions[:, ::2]).shape == (37, 11)
    packed = claray.rays(origins, directions)
    assert packed.shape == shape and (claray.closest_hit(bvh, packed) == expected).all()
    assert (claray.closest_hit(bvh, packed.view(np.float32).reshape(*shape, 8).copy()) == expected).all()
    out = np.empty(shape, claray.HIT)
    assert claray.closest_hit(bvh, origins, directions, out=out) is out and (out == expected).all()
    ends = np.where(np.isfinite(expected["t"]), expected["t"] / 2, 1)
    assert not claray.any_hit(bvh, origins, directions, tmax=ends, masks=np.full(shape, 1)).any()
    assert (claray.count_hits(bvh, origins, directions).ravel() == claray.count_hits(bvh, *rays)).all()
    nearest = claray.nearest_hits(bvh, origins, directions, most=2)
    assert nearest.shape == (*shape, 2) and (nearest.reshape(-1, 2) == claray.nearest_hits(bvh, *rays, most=2)).all()
    assert (claray.all_hits(bvh, origins, directions).elements == claray.all_hits(bvh, *rays).elements).all()
    assert claray.unoccluded(bvh, origins, eye).shape == shape
    for query in (claray.nearest_point, claray.inside, claray.signed_distance):
        options = {} if query is claray.nearest_point else {"open": "vote"}
        found = query(bvh, origins, **options)
        assert found.shape == shape and (found.ravel() == query(bvh, rays[0], **options)).all()
    assert (claray.sphere_overlaps(bvh, origins, np.full(shape, 0.1)).elements
            == claray.sphere_overlaps(bvh, rays[0], 0.1).elements).all()
    placed = claray.InstancedBvh(bvh, np.eye(4)[None])
    assert (claray.closest_hit(placed, origins, directions)["primitive"] == expected["primitive"]).all()
    one = claray.closest_hit(bvh, rays[0][0], rays[1][0])
    assert one.shape == (1,) and one[0] == expected[0, 0]


@pytest.mark.parametrize("learns", [None, False, True])
def test_a_structure_that_learns_has_the_same_hits(soup, rays, learns):
    vertices, triangles, bvh = soup
    learning = claray.Bvh(vertices, triangles, builder="fast", learns=learns)
    assert not learning.is_replaced
    expected, hits = claray.closest_hit(bvh, *rays), claray.closest_hit(learning, *rays)
    assert all(np.array_equal(hits[name], expected[name]) for name in ("t", "primitive"))


def test_ends_and_masks(soup, rays):
    vertices, triangles, bvh = soup
    free = claray.closest_hit(bvh, *rays)
    hit = free["primitive"] != claray.MISS
    short = np.where(hit, free["t"] * 0.99, 1.0)
    assert not claray.any_hit(bvh, *rays, tmax=short).any()
    beyond = claray.closest_hit(bvh, *rays, tmin=np.where(hit, free["t"], 0))
    assert (beyond["t"][hit] > free["t"][hit]).all()
    geometries = np.arange(300) % 2
    masked = claray.Bvh(vertices, triangles, geometries=geometries, masks=[1, 2])
    for mask in (1, 2):
        hits = claray.closest_hit(masked, *rays, masks=np.full(777, mask))
        found = hits["primitive"] != claray.MISS
        assert found.any() and (hits["geometry"][found] == mask - 1).all()
        assert (hits["primitive"][found] % 2 == mask - 1).all()


def test_closed_and_culled():
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    bvh = claray.Bvh(square, [[0, 1, 2], [0, 2, 3]])
    borders = [[0, 0.5, 1], [1, 0.5, 1], [0.5, 0, 1], [0.5, 1, 1]]
    assert claray.any_hit(bvh, borders, (0, 0, -1)).sum() == 2
    assert claray.any_hit(bvh, borders, (0, 0, -1), closed=True).all()
    assert claray.any_hit(bvh, [[0.5, 0.4, 1]], (0, 0, -1), cull_back_faces=True).all()
    assert not claray.any_hit(bvh, [[0.5, 0.4, -1]], (0, 0, 1), cull_back_faces=True).any()


def test_more_rays_than_are_packed_at_once(soup):
    _, _, bvh = soup
    count = (1 << 22) + 5  # python/src/query.cpp packs 2^22 at once
    origins = np.zeros((count, 3), np.float32)
    origins[-3:] = [[0, 0, 5], [0.2, 0.1, 5], [9, 9, 5]]
    out = np.ones(count, bool)
    claray.any_hit(bvh, origins, (0, 0, -1), tmax=np.where(np.arange(count) < count - 3, 0, np.inf), out=out)
    assert not out[:-3].any()
    assert (out[-3:] == claray.any_hit(bvh, origins[-3:], (0, 0, -1))).all()


def test_structures_move_and_are_saved(soup, rays, tmp_path):
    vertices, triangles, bvh = soup
    moved = claray.Bvh(vertices, triangles, builder="binned")
    expected = claray.closest_hit(bvh, rays[0] - np.float32(2), rays[1])
    for move in (moved.refit, moved.rebuild):
        move(vertices + np.float32(2))
        hits = claray.closest_hit(moved, rays[0], rays[1])
        assert ((hits["primitive"] == claray.MISS) == (expected["primitive"] == claray.MISS)).mean() > 0.99
        assert moved.is_valid()
        move(vertices)
        assert (claray.closest_hit(moved, *rays) == claray.closest_hit(bvh, *rays)).all()
    moved.save(tmp_path / "tree.cbvh")
    assert claray.Bvh.load(tmp_path / "tree.cbvh").hash() == moved.hash()
    assert moved.statistics()["triangles"] == moved.triangle_count == 300


def test_threads_share_a_device(soup, rays):
    _, _, bvh = soup
    expected = claray.closest_hit(bvh, *rays)
    wrong = []

    def work():
        for _ in range(20):
            if not (claray.closest_hit(bvh, *rays) == expected).all():
                wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_nothing_leaks(soup, rays):
    _, _, bvh = soup
    arrays = [np.array(rays[0]), np.array(rays[1])]
    claray.closest_hit(bvh, *arrays)
    counts = [sys.getrefcount(array) for array in arrays]
    for _ in range(50):
        hits = claray.closest_hit(bvh, *arrays)
        with pytest.raises(claray.UsageError):
            claray.closest_hit(bvh, arrays[0], arrays[1][1:])
    del hits
    gc.collect()
    assert counts == [sys.getrefcount(array) for array in arrays]


def test_one_end_for_all_rays_is_that_of_each(soup):
    vertices, triangles, _ = soup
    bvh = claray.Bvh(vertices, triangles)
    origins = np.random.default_rng(5).uniform(-1, 1, (50, 3)).astype(np.float32)
    directions = -origins
    for count in (1, 50):
        rays = origins[:count], directions[:count]
        for tmin, tmax in ((0.0, np.inf), (0.1, 0.9), (0, 1), (np.float32(0.25), 2.0)):
            one = claray.closest_hit(bvh, *rays, tmin=tmin, tmax=tmax)
            each = claray.closest_hit(bvh, *rays, tmin=np.full(count, tmin), tmax=np.full(count, tmax))
            assert (one == each).all()
            packed = claray.rays(*rays, tmin=np.full(count, tmin), tmax=np.full(count, tmax))
            assert claray.rays(*rays, tmin=tmin, tmax=tmax).tobytes() == packed.tobytes()
    for name in ("tmin", "tmax"):
        with pytest.raises(claray.UsageError, match=f"^{name}: "):
            claray.closest_hit(bvh, origins, directions, **{name: float("nan")})
