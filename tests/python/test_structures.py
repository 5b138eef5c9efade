"""Primitives, instances and filters."""

import gc
import json
import sys
import warnings

import numpy as np
import pytest

import claray
from test_bad_input import NAN, refused

ODD = claray.Filter("""
static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit) {
    return hit->primitive % 2 == 1;
}""", name="odd")

CUBES = """
static inline PrimitiveBox bounds_of(global const float* data, uint primitive) {
    const float4 cube = vload4(primitive, data);
    const PrimitiveBox box = {cube.xyz - cube.w, cube.xyz + cube.w};
    return box;
}
static inline bool intersect(global const float* data, uint primitive, float3 origin, float3 direction, float tmin, Hit* hit) {
    const float4 cube = vload4(primitive, data);
    const float3 a = (cube.xyz - cube.w - origin) / direction, b = (cube.xyz + cube.w - origin) / direction;
    const float3 near = fmin(a, b), far = fmax(a, b);
    const float in = fmax(fmax(near.x, near.y), near.z), out = fmin(fmin(far.x, far.y), far.z);
    return in <= out && take_hit(in, tmin, hit);
}"""


@pytest.fixture(scope="module")
def cloud():
    """Centres and radii of 200 spheres."""
    rng = np.random.default_rng(7)
    return rng.uniform(-1, 1, (200, 3)).astype(np.float32), rng.uniform(0.02, 0.1, 200).astype(np.float32)


def closest_sphere(centers, radii, origins, directions):
    """Distance and sphere of the closest hit, float64."""
    o, d = origins.astype(np.float64)[:, None] - centers.astype(np.float64), directions.astype(np.float64)[:, None]
    a, b, c = (d * d).sum(-1), (o * d).sum(-1), (o * o).sum(-1) - radii.astype(np.float64) ** 2
    root = np.sqrt(np.maximum(b * b - a * c, 0))
    near, far = (-b - root) / a, (-b + root) / a
    t = np.where(b * b < a * c, np.inf, np.where(near > 0, near, np.where(far > 0, far, np.inf)))
    return t.min(axis=1), t.argmin(axis=1)


def test_spheres_equal_a_brute_force(cloud, rays):
    spheres = claray.Primitives.spheres(*cloud)
    assert spheres.count == 200 and spheres.culled == 0
    hits = claray.closest_hit(spheres, *rays)
    distance, nearest = closest_sphere(*cloud, *rays)
    hit = np.isfinite(distance)
    assert 20 < hit.sum() < 700 and (hits["primitive"][hit] == nearest[hit]).all()
    assert (hits["primitive"][~hit] == claray.MISS).all() and np.isinf(hits["t"][~hit]).all()
    np.testing.assert_allclose(hits["t"][hit], distance[hit], rtol=1e-6)
    assert (claray.any_hit(spheres, *rays) == hit).all()
    assert (claray.any_hit(spheres, *rays, tmax=np.where(hit, hits["t"] * 0.9, 1e9)) == False).all()  # noqa: E712
    for move in (spheres.refit, spheres.rebuild):
        move(cloud[0] + np.float32(0.25), cloud[1] * np.float32(0.5))
        distance, nearest = closest_sphere(cloud[0] + np.float32(0.25), cloud[1] * np.float32(0.5), *rays)
        found = claray.closest_hit(spheres, *rays)["primitive"]
        assert (found == np.where(np.isfinite(distance), nearest, claray.MISS)).all()
        move(*cloud)
    assert (claray.closest_hit(spheres, claray.rays(*rays)) == hits).all()


def test_discs_cylinders_and_curves():
    down = (0, 0, -1)
    discs = claray.Primitives.discs([[0, 0, 0], [0, 0, -1]], [[0, 0, 2], [0, 0, 1]], [1, 2], [0.5, 0])
    hits = claray.closest_hit(discs, [[0.75, 0, 1], [0.25, 0, 1], [3, 0, 1]], down)
    assert hits["t"].tolist() == [1, 2, np.inf] and hits["u"][:2].tolist() == [0.75, 0.25]
    for capped in (True, False):
        tube = claray.Primitives.cylinders([[0, 0, 0]], [[0, 0, 4]], 1, capped=capped)
        assert claray.any_hit(tube, [[0.5, 0, 9]], down).tolist() == [capped]
        side = claray.closest_hit(tube, [[5, 0, 1]], (-1, 0, 0))
        assert side["t"][0] == 4 and side["u"][0] == 0.25
    controls = np.stack([np.arange(7), np.zeros(7), np.zeros(7)], axis=-1)[None]
    over = np.stack([np.linspace(1.1, 4.9, 20), np.zeros(20), np.ones(20)], axis=-1)
    for basis, segments in (("bspline", 4), ("bezier", 2)):
        for shape, top in (("round", 0.1), ("flat", 0.0)):
            hair = claray.Primitives.curves(controls, 0.1, basis=basis, shape=shape)
            assert hair.count == segments
            hits = claray.closest_hit(hair, over, down)
            np.testing.assert_allclose(hits["t"], 1 - top, atol=1e-6)
            np.testing.assert_allclose(claray.any_hit(hair, over + [0, 0.11, 0], down), False)
    hair = claray.Primitives.curves(controls[0], np.full(7, 0.1), [0, 2], basis="bspline")  # from x 1 to 2, and 3 to 4
    place = claray.closest_hit(hair, [[1.25, 0, 1], [2.5, 0, 1], [3.75, 0, 1]], down)
    assert place["primitive"].tolist() == [0, claray.MISS, 1]
    np.testing.assert_allclose(place["u"][[0, 2]], [0.25, 0.75], atol=1e-3)
    hair.refit(controls[0] + [0, 5, 0], 0.1)
    assert claray.any_hit(hair, [[1.25, 5, 1], [1.25, 0, 1]], down).tolist() == [True, False]


def test_shapes_of_a_text(cloud, rays):
    centers, halves = cloud
    cubes = claray.Primitives(CUBES, np.column_stack([centers, halves]), name="cubes")
    hits = claray.closest_hit(cubes, *rays)
    with np.errstate(divide="ignore"):
        a, b = ((centers + sign * halves[:, None] - rays[0][:, None]) / rays[1][:, None] for sign in (-1, 1))
    near, far = np.minimum(a, b).max(-1), np.maximum(a, b).min(-1)
    distance = np.where((near <= far) & (near > 0), near, np.inf)
    hit = np.isfinite(distance.min(axis=1))
    assert hit.sum() > 20 and ((hits["primitive"] != claray.MISS) == hit).all()
    assert (hits["primitive"][hit] == distance.argmin(axis=1)[hit]).all()
    with pytest.raises(claray.DeviceError, match="cubes"):
        claray.Primitives(CUBES.replace("take_hit(in", "take_hit(inn"), [[0, 0, 0, 1]], name="cubes")


def test_filters(soup, rays):
    vertices, triangles, bvh = soup
    lists = claray.all_hits(bvh, *rays)
    odd = [hits[hits["primitive"] % 2 == 1] for hits in lists]
    hits = claray.closest_hit(bvh, *rays, filter=ODD)
    found = np.array([len(o) > 0 for o in odd])
    assert (hits[found] == [o[0] for o in odd if len(o)]).all() and (hits["primitive"][~found] == claray.MISS).all()
    assert (claray.any_hit(bvh, *rays, filter=ODD) == found).all()
    assert (claray.count_hits(bvh, *rays, filter=ODD) == [len(o) for o in odd]).all()
    assert (claray.all_hits(bvh, *rays, filter=ODD).elements == np.concatenate(odd)).all()
    assert (claray.Query(bvh, filter=ODD)(*rays) == hits).all()
    below = claray.Filter("static inline bool accept_hit(global const float* data, float3 o, float3 d, const Hit* hit) "
                          "{ return hit->primitive < data[1]; }", data=[5, 40])
    assert (claray.all_hits(bvh, *rays, filter=below).elements["primitive"] < 40).all()
    assert claray.count_hits(bvh, *rays, filter=below).sum() == (lists.elements["primitive"] < 40).sum() > 0
    parts = claray.Bvh(vertices, triangles, geometries=np.arange(300) // 100)
    ranged = claray.all_hits(parts, *rays, filter=claray.geometry_range(1, 2)).elements
    assert len(ranged) == (lists.elements["primitive"] // 100 == 1).sum() > 0 and (ranged["geometry"] == 1).all()


def placements(count, seed):
    """Rotations, scales and translations: (count, 4, 4)."""
    rng = np.random.default_rng(seed)
    matrices = np.tile(np.eye(4), (count, 1, 1))
    matrices[:, :3, :3] = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0] * rng.uniform(0.5, 1, (count, 1, 1))
    matrices[:, :3, 3] = rng.uniform(-1.5, 1.5, (count, 3))
    return matrices


def moved(vertices, matrices):
    return (vertices @ np.moveaxis(matrices[:, :3, :3], 1, 2) + matrices[:, None, :3, 3]).reshape(-1, 3)


def test_instances_equal_their_copies(soup, rays):
    vertices, triangles, bvh = soup
    half = claray.Bvh(vertices, triangles[:150])
    matrices = placements(9, 8)
    which = np.arange(9) % 2
    placed = claray.InstancedBvh([bvh, half], matrices, bottoms=which)
    assert placed.is_valid() and placed.statistics()["instances"] == placed.instance_count == 9 and not placed.moves

    def check(matrices):
        hits = claray.closest_hit(placed, *rays)
        faces = np.concatenate([(triangles[:150] if w else triangles) + 900 * i for i, w in enumerate(which)])
        copies = claray.closest_hit(claray.Bvh(moved(vertices.astype(np.float64), matrices), faces,
                                               geometries=np.repeat(np.arange(9), np.where(which, 150, 300))), *rays)
        first = np.concatenate([[0], np.cumsum(np.where(which, 150, 300))])
        hit = copies["primitive"] != claray.MISS
        agree = (hits["primitive"] != claray.MISS) == hit
        assert agree.mean() > 0.995 and 50 < hit.sum() < 770  # rays past edges, which rounding decides
        both = hit & agree
        same = (hits["instance"] == copies["geometry"]) & (hits["primitive"] == copies["primitive"] - first[copies["geometry"].clip(0, 8)])
        assert same[both].mean() > 0.99
        np.testing.assert_allclose(hits["t"][both & same], copies["t"][both & same], rtol=1e-4, atol=1e-4)
        assert (claray.any_hit(placed, *rays) == (hits["primitive"] != claray.MISS)).all()
        return hits

    first = check(matrices)
    for move in (placed.refit, placed.rebuild):
        move(placements(9, 9)[:, :3])  # (N, 3, 4)
        check(placements(9, 9))
    placed.rebuild(matrices)
    assert (check(matrices) == first).all()
    masked = claray.InstancedBvh([bvh, half], matrices, bottoms=which, masks=1 << which)
    seen = claray.closest_hit(masked, *rays, masks=np.full(777, 2))
    found = seen["primitive"] != claray.MISS
    assert found.sum() > 50 and (seen["instance"][found] % 2 == 1).all()


def test_instances_of_a_scene_equal_its_triangles(tmp_path):
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0], "scale": [1, 2, 1], "children": [2]},
                      {"mesh": 0, "translation": [0, 0, 1]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "t.bin", "byteLength": 36}]}
    np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).tofile(tmp_path / "t.bin")
    (tmp_path / "t.gltf").write_text(json.dumps(gltf))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = claray.load(str(tmp_path / "t.gltf"))
    placed, flat = claray.InstancedBvh.of_scene(scene), claray.Bvh(scene)
    assert placed.instance_count == 3 and scene.instances["ends"] is None and len(set(scene.instances["meshes"])) == 1
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0.03, 4.1, 60), np.linspace(0.02, 2.3, 40)))
    origins = np.stack([x, y, np.full_like(x, 5)], 1)
    hits, copies = (claray.closest_hit(bvh, origins, [0, 0, -1]) for bvh in (placed, flat))
    hit = copies["primitive"] != claray.MISS
    assert ((hits["primitive"] != claray.MISS) == hit).all() and hit.sum() > 200
    np.testing.assert_allclose(hits["t"][hit], copies["t"][hit], rtol=1e-6)
    assert (hits["instance"][hit] == copies["primitive"][hit]).all() and set(hits["instance"][hit]) == {0, 2}
    refused("scene", lambda: claray.InstancedBvh.of_scene(claray.Scene()))


def test_levels_of_instances_equal_one_level(soup, rays):
    """Two groups, one of which holds the other, against products of the matrices."""
    vertices, triangles, bvh = soup
    half = claray.Bvh(vertices, triangles[:150])
    twig, branch, root = placements(3, 11), placements(2, 12), placements(2, 13)
    groups = [claray.Instances(twig, [0, 1, 0], [1, 2, 3]), claray.Instances(branch[:, :3], [2, 1], [3, 2])]
    flat = claray.flatten(claray.Instances(root, [3, 0]), groups, 2)
    expected = [(0, 0, 0), (0, 0, 1), (0, 0, 2), (0, 1), (1,)]
    assert [tuple(steps) for steps in flat.steps] == expected
    products = [root[0] @ branch[0] @ m for m in twig] + [root[0] @ branch[1], root[1]]
    np.testing.assert_allclose(flat.transforms, np.array(products)[:, :3], rtol=1e-6, atol=1e-6)
    assert flat.bottoms.tolist() == [0, 1, 0, 1, 0] and flat.masks.tolist() == [1, 2, 3, 2, claray.MISS]
    placed = claray.InstancedBvh([bvh, half], flat.transforms, bottoms=flat.bottoms, masks=flat.masks)
    hits = claray.closest_hit(placed, *rays)
    assert set(hits["instance"]) == {0, 1, 2, 3, 4, claray.MISS}
    one = claray.flatten(claray.Instances(root), [])
    assert one.bottoms.tolist() == [0, 0] and [list(s) for s in one.steps] == [[0], [1]]
    refused("roots", lambda: claray.flatten(root, []))
    refused(r"groups\[1\]", lambda: claray.flatten(claray.Instances(root), [groups[0], (branch, None)]))
    refused(r"groups\[0\].masks", lambda: claray.flatten(claray.Instances(root), [claray.Instances(twig, masks=[1, 2])]))
    refused("roots.transforms", lambda: claray.flatten(claray.Instances(root[0]), []))
    refused("structures", lambda: claray.flatten(claray.Instances(root), [], 0))
    with pytest.raises(claray.UsageError, match="group 0 contains itself"):
        claray.flatten(claray.Instances(root, [1, 0]), [claray.Instances(twig, [0, 1, 0])])
    with pytest.raises(claray.UsageError, match="bottom level 3 of 1 structures and 2 groups"):
        claray.flatten(claray.Instances(root, [3, 0]), groups[:2], 1)


def test_only_rays_ask_primitives(cloud, rays):
    spheres = claray.Primitives.spheres(*cloud)
    boxes = np.zeros((1, 3)), np.ones((1, 3))
    for query in (lambda: claray.nearest_point(spheres, rays[0]), lambda: claray.inside(spheres, rays[0]),
                  lambda: claray.signed_distance(spheres, rays[0]), lambda: claray.count_hits(spheres, *rays),
                  lambda: claray.nearest_hits(spheres, *rays, most=2), lambda: claray.all_hits(spheres, *rays),
                  lambda: claray.box_overlaps(spheres, *boxes), lambda: claray.sphere_overlaps(spheres, boxes[0], 1)):
        refused("bvh", query, "is a Primitives; use a claray.Bvh")


def test_instances_move_while_rays_pass(soup, rays):
    vertices, triangles, bvh = soup
    begin, end = placements(3, 3), placements(3, 3)
    end[:, :3, 3] += [1, 0, 0]
    placed = claray.InstancedBvh(bvh, begin, ends=end)
    assert placed.moves
    for time in (0, 0.5, 1):
        still = begin.copy()
        still[:, 0, 3] += time
        expected = claray.any_hit(claray.InstancedBvh(bvh, still), *rays)
        assert (claray.any_hit(placed, *rays, times=time) == expected).mean() > 0.995 and expected.sum() > 20
    mixed = claray.any_hit(placed, *rays, times=np.linspace(0, 1, 777))
    assert mixed[0] == claray.any_hit(placed, *rays)[0] and mixed[-1] == claray.any_hit(placed, *rays, times=1)[-1]
    placed.refit(end, begin)
    assert (claray.any_hit(placed, *rays, times=1) == claray.any_hit(claray.InstancedBvh(bvh, begin), *rays)).mean() > 0.995
    refused("times", lambda: claray.any_hit(placed, *rays, times=1.5), "0 to 1")
    refused("times", lambda: claray.any_hit(bvh, *rays, times=0))
    refused("ends", lambda: placed.refit(begin))


def test_wrong_arguments_are_named(soup, cloud, rays):
    _, _, bvh = soup
    centers, radii = cloud
    spheres, make = claray.Primitives.spheres(centers, radii), claray.Primitives
    refused("centers", lambda: make.spheres(NAN, 1), "row 1")
    refused("centers", lambda: make.spheres(centers[:0], 1), "empty")
    refused("radii", lambda: make.spheres(centers, -radii), "row")
    refused("radii", lambda: make.spheres(centers, radii[1:]), r"\(199,\)")
    refused("normals", lambda: make.discs(centers, centers[1:], 1), "199 rows")
    refused("ends", lambda: make.cylinders(centers, centers[1:], 1))
    refused("points", lambda: make.curves(np.zeros((2, 3, 3)), 1), "at least 4")
    refused("points", lambda: make.curves(np.zeros((2, 5, 3)), 1, basis="bezier"), "7")
    refused("segments", lambda: make.curves(centers, 1, [197]), "index 197")
    refused("radii", lambda: make.curves(np.zeros((2, 4, 3)), np.ones((2, 3))))
    refused("basis", lambda: make.curves(np.zeros((1, 4, 3)), 1, basis="cubic"))
    refused("builder", lambda: make.spheres(centers, radii, builder="best"))
    refused("source", lambda: make("", [[1]]))
    refused("data", lambda: make(CUBES, [1, 2]), r"\(2,\)")
    refused("data", lambda: make(CUBES, [[0, np.nan]]), "row 0")
    refused("arrays", lambda: spheres.refit(centers[1:], radii[1:]), "796 numbers")
    for name, value in (("cull_back_faces", True), ("closed", True), ("filter", ODD), ("masks", np.ones(777, int))):
        refused(name, lambda: claray.any_hit(spheres, *rays, **{name: value}), "Primitives")
    refused("source", lambda: claray.Filter(" "))
    refused("data", lambda: claray.Filter("x", data=[[1]]))
    refused("first", lambda: claray.geometry_range(-1, 2))
    with pytest.raises(claray.DeviceError, match="broken"):
        claray.closest_hit(bvh, *rays, filter=claray.Filter("static inline bool accept_hit(", name="broken"))
    placed = claray.InstancedBvh(bvh, np.eye(4)[None])
    refused("filter", lambda: claray.any_hit(placed, *rays, filter=ODD), "InstancedBvh")
    refused("bvhs", lambda: claray.InstancedBvh([], np.eye(4)[None]))
    refused("bvhs", lambda: claray.InstancedBvh([spheres], np.eye(4)[None]))
    refused("transforms", lambda: claray.InstancedBvh(bvh, np.eye(4)), r"\(4, 4\)")
    refused("transforms", lambda: claray.InstancedBvh(bvh, np.full((2, 3, 4), np.nan)), "row 0")
    refused("transforms", lambda: claray.InstancedBvh(bvh, np.ones((1, 4, 4))), "last row")
    refused("transforms", lambda: claray.InstancedBvh(bvh, np.zeros((0, 4, 4))), "empty")
    refused("transforms", lambda: placed.refit(np.tile(np.eye(4), (2, 1, 1))), "2 matrices")
    refused("bottoms", lambda: claray.InstancedBvh(bvh, np.eye(4)[None], bottoms=[1]), "1 structures")
    refused("ends", lambda: claray.InstancedBvh(bvh, np.eye(4)[None], ends=np.tile(np.eye(4), (2, 1, 1))))
    refused("ends", lambda: placed.refit(np.eye(4)[None], np.eye(4)[None]))
    singular = claray.InstancedBvh(bvh, np.stack([np.eye(4), np.diag([0, 1, 1, 1])]))
    assert singular.statistics()["culled"] == 1


def test_nothing_leaks(soup, cloud, rays):
    _, _, bvh = soup
    given = [np.array(rays[0]), np.array(rays[1]), np.array(cloud[0]), np.array(cloud[1])]

    def work():
        spheres = claray.Primitives.spheres(given[2], given[3])
        placed = claray.InstancedBvh(bvh, np.eye(4)[None])
        for structure in (spheres, placed):
            claray.closest_hit(structure, given[0], given[1])
        claray.closest_hit(bvh, given[0], given[1], filter=ODD)
        claray.all_hits(bvh, given[0], given[1])
        claray.nearest_point(bvh, given[0])
        claray.sphere_overlaps(bvh, given[2], given[3])
        with pytest.raises(claray.UsageError):
            claray.nearest_point(bvh, given[0], reach=-1)

    work()
    gc.collect()
    objects = [*given, bvh, bvh._native, ODD, ODD._native, bvh.device]
    counts, queries = [sys.getrefcount(o) for o in objects], len(bvh._queries)
    for _ in range(10):
        work()
    gc.collect()
    assert counts == [sys.getrefcount(o) for o in objects] and len(bvh._queries) == queries
