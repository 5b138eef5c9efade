"""Structures over float64 with an origin of their own; instances that come and go; results by DLPack."""

import warnings

import numpy as np
import pytest

import claray
from test_bad_input import refused

FAR = np.array([4_500_000.0, 250.0, -5_400_000.0])  # a map in metres


def rounded(points):
    """To multiples of 2**-16, so that float64 holds them plus FAR exactly."""
    return (np.round(points * 2.0**16) * 2.0**-16).astype(np.float32)


@pytest.fixture(scope="module")
def soup():
    rng = np.random.default_rng(1)
    corners = rng.uniform(-1, 1, (300, 1, 3)) + rng.uniform(-0.3, 0.3, (300, 3, 3))
    vertices, triangles = rounded(corners.reshape(-1, 3)), np.arange(900).reshape(-1, 3)
    return vertices, triangles, claray.Bvh(vertices, triangles)


@pytest.fixture(scope="module")
def rays():
    rng = np.random.default_rng(2)
    return rounded(rng.uniform(-2, 2, (777, 3))), rng.normal(size=(777, 3)).astype(np.float32)


@pytest.fixture(scope="module")
def far(soup):
    vertices, triangles, _ = soup
    return claray.Bvh(vertices.astype(np.float64) + FAR, triangles, origin=FAR)


def test_queries_of_far_places_are_those_of_near_ones(soup, rays, far):
    vertices, triangles, near = soup
    origins, directions = rays
    there = origins.astype(np.float64) + FAR
    assert far.origin == tuple(FAR) and near.origin is None
    hits = claray.closest_hit(near, origins, directions)
    assert (claray.closest_hit(far, there, directions) == hits).all() and (hits["primitive"] != claray.MISS).sum() > 100
    assert (claray.Query(far, "any")(there, directions) == claray.any_hit(near, origins, directions)).all()
    assert (claray.closest_hit(far, there[0], directions) == claray.closest_hit(near, origins[0], directions)).all()
    assert (claray.unoccluded(far, there, there[::-1]) == claray.unoccluded(near, origins, origins[::-1])).all()
    assert (claray.count_hits(far, there, directions) == claray.count_hits(near, origins, directions)).all()
    assert (claray.nearest_hits(far, there, directions, most=2) == claray.nearest_hits(near, origins, directions, most=2)).all()
    assert (claray.all_hits(far, there, directions).elements == claray.all_hits(near, origins, directions).elements).all()
    assert (claray.sphere_overlaps(far, there, 0.2).elements == claray.sphere_overlaps(near, origins, 0.2).elements).all()
    boxes = (claray.box_overlaps(bvh, points - 0.25, points + 0.25).elements
             for bvh, points in ((far, there), (near, origins.astype(np.float64))))
    assert np.array_equal(*boxes)
    for query in (claray.inside, claray.signed_distance):
        assert (query(far, there, open="vote") == query(near, origins, open="vote")).all()
    there_found, found = claray.nearest_point(far, there), claray.nearest_point(near, origins)
    assert there_found.dtype == claray.NEAREST64 and found.dtype == claray.NEAREST
    assert np.abs(there_found["point"] - FAR - found["point"]).max() < 1e-8
    assert (there_found["distance"] == found["distance"]).all()


def test_the_middle_is_an_origin(soup, rays, tmp_path):
    vertices, triangles, near = soup
    there = vertices.astype(np.float64) + FAR
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bvh = claray.Bvh(there, triangles, origin="auto")
    assert np.allclose(bvh.origin, 0.5 * (there.min(axis=0) + there.max(axis=0)))
    with pytest.warns(UserWarning, match="origin='auto'"):
        claray.Bvh(there, triangles)
    same = lambda bvh: (claray.closest_hit(bvh, rays[0] + FAR, rays[1])["primitive"]
                        == claray.closest_hit(near, *rays)["primitive"]).mean()
    assert same(bvh) > 0.99  # not all: the rounding differs
    bvh.rebuild(there + 1)
    assert same(bvh) < 0.9
    bvh.refit(there)
    assert same(bvh) > 0.99
    bvh.save(tmp_path / "tree")
    assert same(claray.Bvh.load(tmp_path / "tree", origin=bvh.origin)) > 0.99
    refused("origin", lambda: claray.Bvh(there, triangles, origin="middle"), "auto")
    refused("origin", lambda: claray.Bvh(there, triangles, origin=(1, 2)))
    refused("origin", lambda: claray.Bvh(there, triangles, origin=(1, 2, np.inf)))
    refused("origin", lambda: claray.Bvh(claray.load("cornell"), origin="auto"), "Scene")
    refused("bvhs", lambda: claray.InstancedBvh(bvh, np.eye(4)[None]), "origin")


def test_rays_in_one_array_tell_their_origin(far, rays, soup):
    there = rays[0] + FAR
    packed = claray.rays(there, rays[1], origin=far.origin)
    for query in (claray.closest_hit, claray.count_hits):
        assert (query(far, packed) == query(soup[2], *rays)).all()
        refused("rays", lambda: query(far, claray.rays(*rays)), "another origin")
        refused("rays", lambda: query(soup[2], packed), "another origin")
    assert (claray.closest_hit(far, np.array(packed)) == claray.closest_hit(soup[2], *rays)).all()  # taken to be local


def moved(*places):
    matrices = np.tile(np.eye(4), (len(places), 1, 1))
    matrices[:, 0, 3] = places
    return matrices


def test_instances_come_and_go(soup, rays):
    bvh = soup[2]
    placed = claray.InstancedBvh(bvh, moved(0))
    query = claray.Query(placed)
    for places in ((-3, 3), (0, 1, 2, 5), (4,), (1,)):
        placed.rebuild(moved(*places))
        fresh = claray.closest_hit(claray.InstancedBvh(bvh, moved(*places)), *rays)
        assert placed.instance_count == len(places)
        assert (query(*rays) == fresh).all() and (claray.closest_hit(placed, *rays) == fresh).all()
    placed.refit(moved(2))
    assert (query(*rays) == claray.closest_hit(claray.InstancedBvh(bvh, moved(2)), *rays)).all()
    refused("transforms", lambda: placed.refit(moved(1, 2)), "1 instances")
    refused("transforms", lambda: placed.rebuild(moved()[:0]), "empty")
    refused("ends", lambda: placed.rebuild(moved(1, 2), moved(1, 2)))
    assert placed.instance_count == 1 and (query(*rays)["instance"][query(*rays)["primitive"] != claray.MISS] == 0).all()


def test_structures_and_masks_of_instances_change(soup, rays):
    bvh, single = soup[2], claray.Bvh([[9, 0, 0], [9, 1, 0], [9, 0, 1]], [[0, 1, 2]])
    placed = claray.InstancedBvh([bvh, single], moved(0, 0), bottoms=[0, 1], masks=[1, 2])
    refused("bottoms", lambda: placed.rebuild(moved(0, 1, 2)))
    refused("masks", lambda: placed.rebuild(moved(0, 1), bottoms=[0, 0]))
    refused("bvhs", lambda: placed.rebuild(moved(0, 1, 2), bottoms=[0, 0, 1], masks=[1, 1, 1]))
    placed.rebuild(moved(0, 1, 2), bvhs=[single, bvh], bottoms=[0, 0, 1], masks=[1, 1, 1])
    fresh = claray.InstancedBvh([single, bvh], moved(0, 1, 2), bottoms=[0, 0, 1])
    assert (claray.closest_hit(placed, *rays) == claray.closest_hit(fresh, *rays)).all()
    moving = claray.InstancedBvh(bvh, moved(0), ends=moved(1))
    moving.rebuild(moved(0, 3), moved(1, 4))
    fresh = claray.InstancedBvh(bvh, moved(0, 3), ends=moved(1, 4))
    assert (claray.closest_hit(moving, *rays, times=0.5) == claray.closest_hit(fresh, *rays, times=0.5)).all()


def test_results_are_taken_by_dlpack_without_copies(soup, rays):
    hits = claray.closest_hit(soup[2], *rays)
    for array in (claray.any_hit(soup[2], *rays).view(np.uint8), claray.signed_distance(soup[2], rays[0], open="vote"), hits["t"], hits["primitive"],
                  claray.render(claray.load("cornell"), width=8, height=8, spp=1)):
        taken = np.from_dlpack(array)
        assert np.shares_memory(taken, array) and (taken == array).all()
