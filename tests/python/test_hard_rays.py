"""The kit of hard rays (bench/hardrays): its answers are exact and the same everywhere, its judge finds faults, and claray has none."""

import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench/hardrays"))

import judge  # noqa: E402
from adapters import claray as adapter  # noqa: E402
from cases import CASES  # noqa: E402
from exact import cross, dot, side_signs  # noqa: E402
from generate import committed_hashes, hash_of  # noqa: E402


@pytest.fixture(scope="module")
def axis():
    return CASES["axis"]()


@pytest.fixture(scope="module")
def lengths():
    return CASES["lengths"]()


@pytest.fixture(scope="module")
def tetrahedron():
    return CASES["tetrahedron"]()


def test_each_case_has_a_hash():
    assert list(committed_hashes()) == list(CASES)


@pytest.mark.parametrize("name", ["axis", "lengths", "tetrahedron"])
def test_the_arrays_are_the_same_everywhere(name, request):
    assert hash_of(request.getfixturevalue(name)) == committed_hashes()[name]


@pytest.mark.parametrize("name", ["axis", "lengths"])
def test_claray_has_no_wrong_rays(name, request):
    case = request.getfixturevalue(name)
    scene, rays = adapter.make(case["positions"], case["triangles"]), (case["origins"], case["directions"])
    found = judge.hits(case, *adapter.closest_hit(scene, *rays))
    assert (found["wrong"], found["primitive"]) == (0, 0), found
    assert judge.occlusion(case, adapter.occluded(scene, *rays))["wrong"] == 0
    assert judge.counts(case, adapter.count_hits(scene, *rays))["wrong"] == 0


def test_claray_has_no_wrong_points(tetrahedron):
    scene = adapter.make(tetrahedron["positions"], tetrahedron["triangles"])
    assert judge.distances(tetrahedron, adapter.distance(scene, tetrahedron["points"]))["wrong"] == 0
    assert judge.signs(tetrahedron, adapter.inside(scene, tetrahedron["points"]))["wrong"] == 0


def test_signs_are_exact_where_float64_is_not():
    rng = np.random.default_rng(1)
    corners = rng.integers(-2**23, 2**23, (500, 3, 3)).astype(np.float64)
    origins = rng.integers(-2**23, 2**23, (500, 3)).astype(np.float64)
    directions = corners[:, 0] - origins  # exactly through the first corner, which lies on two edges
    volume = dot(directions, cross(corners[:, 0] - origins, corners[:, 1] - origins))
    assert (volume != 0).sum() > 100  # the volume is 0, but not in float64
    assert (side_signs(origins, directions, corners)[:, 1:] == 0).all()


def right_answers(case):
    """The first accepted answer of each ray."""
    first = np.minimum(case["first"][:-1], len(case["t"]) - 1)
    return case["expect"] != judge.MISS, case["t"][first], case["primitive"][first]


def test_the_judge_finds_each_fault(axis):
    hit, t, primitive = right_answers(axis)
    assert judge.hits(axis, hit, t, primitive)["wrong"] == 0
    must, must_not = np.flatnonzero(axis["expect"] == judge.HIT), np.flatnonzero(axis["expect"] == judge.MISS)
    assert len(must) > 1000 and len(must_not) > 1000 and (axis["expect"] == judge.EITHER).sum() > 100
    changed = hit.copy()
    changed[must[:3]], changed[must_not[:2]] = False, True
    found = judge.hits(axis, changed, np.where(np.arange(len(t)) == must[5], 1.001 * t, t), primitive)
    assert (found["missed"], found["false"], found["distance"], found["wrong"]) == (3, 2, 1, 6)
    assert judge.hits(axis, hit, t, primitive + 1)["primitive"] > 1000


def brute_force(case, ray):
    """The triangles that the ray meets away from their edges, and the distances, in fractions."""
    exact = np.vectorize(lambda x: Fraction(float(x)), otypes=[object])
    o, d = exact(case["origins"][ray]), exact(case["directions"][ray])
    a, b, c = (exact(case["positions"])[case["triangles"][:, k]] for k in range(3))
    e, f, s = b - a, c - a, o - a
    p, q = np.cross(d, f), np.cross(s, e)
    size = (e * p).sum(axis=1)
    flat = size == 0
    size[flat] = Fraction(1)
    u, v, t = (s * p).sum(axis=1) / size, (q * d).sum(axis=1) / size, (f * q).sum(axis=1) / size
    met = np.flatnonzero(~flat & (u > 0) & (v > 0) & (u + v < 1) & (t > 0))
    return met, t[met]


def test_the_answers_are_those_of_another_exact_method(axis):
    for ray in range(0, len(axis["expect"]), 1500):
        met, t = brute_force(axis, ray)
        accepted = slice(axis["first"][ray], axis["first"][ray + 1])
        if len(met):
            nearest = met[np.argmin(t)]
            assert axis["expect"][ray] == judge.HIT
            listed = np.flatnonzero(axis["primitive"][accepted] == nearest)
            earlier = axis["t"][accepted].max() < t.min()  # an edge or a vertex that the ray must hit
            assert earlier or len(listed) and axis["t"][accepted][listed[0]] == float(t.min())
