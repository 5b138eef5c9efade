"""What is wrong is an exception that begins with the argument's name; nothing is traced."""

import warnings

import numpy as np
import pytest

import claray

NAN = np.array([[0, 0, 0], [0, np.nan, 0], [0, 0, 1]], np.float32)


def refused(name, call, words=""):
    with pytest.raises(claray.UsageError, match=f"^{name}: .*{words}") as raised:
        call()
    assert "\n" not in str(raised.value)
    assert isinstance(raised.value, ValueError)


def test_arrays_of_structures(soup):
    vertices, triangles, _ = soup
    refused("vertices", lambda: claray.Bvh(vertices[:, :2], triangles), r"\(900, 2\)")
    refused("vertices", lambda: claray.Bvh(vertices.ravel(), triangles))
    refused("vertices", lambda: claray.Bvh(vertices.astype(complex), triangles), "complex")
    refused("vertices", lambda: claray.Bvh([["a", "b", "c"]], triangles))
    refused("vertices", lambda: claray.Bvh([[0, 0, 0], [0, 0]], triangles))
    refused("vertices", lambda: claray.Bvh(NAN, [[0, 1, 2]]), "row 1")
    refused("vertices", lambda: claray.Bvh(np.full((3, 3), 1e39), [[0, 1, 2]]), "row 0")
    refused("triangles", lambda: claray.Bvh(vertices, triangles.astype(float)), "float64")
    refused("triangles", lambda: claray.Bvh(vertices, triangles + 1), "index 900")
    refused("triangles", lambda: claray.Bvh(vertices, -triangles - 1), "index -900")
    refused("triangles", lambda: claray.Bvh(vertices, triangles[:0]), "empty")
    refused("triangles", lambda: claray.Bvh(vertices), "missing")
    refused("geometries", lambda: claray.Bvh(vertices, triangles, geometries=[1, 2]), r"\(300,\)")
    refused("masks", lambda: claray.Bvh(vertices, triangles, geometries=np.full(300, 4), masks=[1, 2]))
    refused("builder", lambda: claray.Bvh(vertices, triangles, builder="best"), "balanced")
    refused("layout", lambda: claray.Bvh(vertices, triangles, layout="round"))
    refused("vertices", lambda: claray.Bvh(vertices, triangles).refit(vertices[1:]), "899 rows")


def test_arrays_of_rays(soup, rays):
    _, _, bvh = soup
    origins, directions = rays
    hit = claray.closest_hit
    refused("origins", lambda: hit(bvh, origins[:, :2], directions))
    refused("directions", lambda: hit(bvh, origins, directions[1:]), "776 rows")
    refused("directions", lambda: hit(bvh, origins, "up"))
    refused("rays", lambda: hit(bvh, origins), r"\(777, 3\)")
    rows = origins.reshape(37, 21, 3)
    refused("directions", lambda: hit(bvh, rows, directions), "777 rows.*37 x 21 rows")
    refused("origins", lambda: hit(bvh, rows.transpose(2, 0, 1), rows))
    refused("tmax", lambda: hit(bvh, rows, rows, tmax=np.ones(777)), r"\(37, 21\)")
    refused("masks", lambda: hit(bvh, rows, rows, masks=np.ones(777, int)), r"\(37, 21\)")
    refused("out", lambda: hit(bvh, rows, rows, out=np.empty(777, claray.HIT)))
    refused("points", lambda: claray.unoccluded(bvh, origins[:, :2], directions))
    refused("targets", lambda: claray.unoccluded(bvh, origins, directions[1:]), "776 rows")
    refused("tmin", lambda: hit(bvh, origins, directions, tmin=-1))
    refused("tmin", lambda: hit(bvh, origins, directions, tmin=np.nan))
    refused("tmax", lambda: hit(bvh, origins, directions, tmax=np.ones(5)))
    refused("masks", lambda: hit(bvh, origins, directions, masks=np.ones(777)), "float64")
    refused("masks", lambda: hit(bvh, origins, directions, masks=np.full(777, -1)))
    refused("out", lambda: hit(bvh, origins, directions, out=np.empty(777)))
    refused("out", lambda: hit(bvh, origins, directions, out=np.empty(2 * 777, claray.HIT)[::2]), "contiguous")
    refused("coherence", lambda: hit(bvh, origins, directions, coherence="maybe"))
    refused("bvh", lambda: hit(None, origins, directions), "NoneType")
    refused("kind", lambda: claray.Query(bvh, "all"))
    assert len(hit(bvh, origins[:0], directions[:0])) == 0
    assert claray.any_hit(bvh, np.zeros((0, 3)), (0, 0, 1)).shape == (0,)


def test_coordinates_that_float32_rounds_are_warned_of():
    corners, triangle = np.array([[0.05, 0.15, 0], [2, 0, 0], [0, 2, 0]]), [[0, 1, 2]]
    far = corners + [447123.05, 4132567.15, 120]
    for build in (lambda v: claray.Bvh(v, triangle), lambda v: claray.Scene().add_mesh(v, triangle),
                  lambda v: claray.Primitives.spheres(v, 0.1)):
        with pytest.warns(UserWarning, match=r"float32 rounds them by up to 0\.1, and their extent is 2;") as caught:
            build(far)
        assert caught[0].filename == __file__
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for near in (corners, far.round().tolist(), far.astype(np.float32), corners * 1e9, far * [0, 0, 1]):
                build(near)


def test_rays_that_are_not_finite(soup, rays):
    _, _, bvh = soup
    for bad in (np.nan, np.inf, 1e39):
        for name, index in (("origins", 0), ("directions", 1)):
            given = [rays[0].astype(np.float64), rays[1].astype(np.float64)]
            given[index][123, 1] = bad
            refused(name, lambda: claray.closest_hit(bvh, *given), "row 123")
            refused(name, lambda: claray.rays(*given), "row 123")
            hits = claray.closest_hit(bvh, *given, nan="miss")
            assert hits["primitive"][123] == claray.MISS
            packed = np.array(claray.rays(*given, nan="miss"))
            refused("rays", lambda: claray.closest_hit(bvh, packed), "row 123")
            assert (claray.closest_hit(bvh, packed, nan="miss") == hits).all()


def test_vertices_that_are_no_numbers_can_be_omitted():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [np.nan, 0, 1], [1e39, 0, 0]]
    bvh = claray.Bvh(vertices, [[0, 1, 3], [0, 1, 2], [4, 1, 2]], nan="omit")
    assert bvh.statistics()["culled"] == 2
    hit = claray.closest_hit(bvh, [[0.2, 0.2, 1]], [[0, 0, -1]])[0]
    assert hit["primitive"] == 1 and hit["t"] == 1
    refused("nan", lambda: claray.Bvh(vertices, [[0, 1, 2]], nan="miss"))


def test_devices_files_and_options(tmp_path):
    with pytest.raises(claray.UsageError, match="no device matches 'abacus'"):
        claray.Device("abacus")
    with pytest.raises(claray.InputError, match="nowhere.obj"):
        claray.load(tmp_path / "nowhere.obj")
    with pytest.raises(claray.UsageError, match="cornell"):
        claray.load("corneL")
    (tmp_path / "bad.ply").write_text("ply\n")
    with pytest.raises(claray.InputError, match="bad.ply' line 1"):
        claray.load(tmp_path / "bad.ply")
    scene = claray.load("cornell")
    refused("widht", lambda: claray.Renderer(scene, widht=5))
    refused("spp", lambda: claray.Renderer(scene, spp=-1))
    refused("spp", lambda: claray.Renderer(scene, spp=2.5))
    refused("scene", lambda: claray.Renderer("cornell"))
    refused("Material", lambda: claray.Material(colour=(1, 0, 0)), "colour")
    refused("albedo", lambda: claray.Material(albedo=(1, 0)))
    refused("study", lambda: claray.accuracy(scene, "guesses"), "sampling")
    refused("normals", lambda: claray.Scene().add_mesh(np.eye(3), [[0, 1, 2]], normals=np.eye(3)[:2]))
    with pytest.raises(claray.UsageError, match="no-such-case"):
        claray.verify(["no-such-case"])
