"""claray.trimesh.proximity against closed forms, and against trimesh's brute force in float64."""

import copy
import pickle

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")  # which trimesh's proximity needs

import claray  # noqa: E402
from claray.trimesh import RayMeshIntersector, install, proximity  # noqa: E402


def box_distance(points, half):
    """The signed distance of a box around the origin, positive inside."""
    beyond = np.abs(points) - half
    return -np.linalg.norm(np.maximum(beyond, 0), axis=1) - np.minimum(beyond.max(axis=1), 0)


def grid(n):
    """A square of n x n squares in the plane z = 0, 1 wide."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    i = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (part.ravel() for part in (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]))
    return trimesh.Trimesh(np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]),
                           np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]), process=False)


@pytest.mark.parametrize("place, scale", [((0, 0, 0), 1), ((1e4, -2e4, 3e4), 1e-3), ((0, 0, 0), 1e-7), ((0, 0, 0), 1e9)])
def test_nearest_points_are_those_of_float64(place, scale):
    rng = np.random.default_rng(1)
    mesh = trimesh.Trimesh(**trimesh.triangles.to_kwargs(rng.normal(size=(150, 1, 3)) + 0.3 * rng.normal(size=(150, 3, 3))))
    points = 1.5 * rng.normal(size=(400, 3))
    near, distance, _ = trimesh.proximity.closest_point_naive(mesh, points)
    mesh.apply_scale(scale).apply_translation(place)
    closest, distances, triangles = proximity.closest_point(mesh, points * scale + place)
    assert closest.dtype == distances.dtype == np.float64 and triangles.dtype == np.int64
    resolution = 4e-16 * (1 + np.abs(place).max() / scale)
    assert np.abs(distances / scale - distance).max() < 10 * resolution
    assert np.abs((closest - place) / scale - near).max() < 100 * resolution
    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[triangles], closest, method="cross")
    assert weights.min() > -1e-9 * resolution / 4e-16 and weights.max() < 1 + 1e-9 * resolution / 4e-16  # of the triangle


def test_feet_are_exact_where_float32_sees_ties():
    """Above a fine plane the distances of thousands of triangles are one number of float32."""
    rng = np.random.default_rng(2)
    points = np.column_stack([rng.uniform(0, 1, (50, 2)), np.full(50, 300.0)])
    closest, distances, _ = proximity.closest_point(grid(60), points)
    assert np.abs(closest - points * [1, 1, 0]).max() < 1e-13 and (distances == 300).all()


def test_centres_of_round_things_take_bounded_memory(monkeypatch):
    from claray.trimesh import _structure
    ball = trimesh.creation.icosphere(subdivisions=0)  # of 20 triangles, which are all nearest to the centre
    monkeypatch.setattr(_structure, "_MOST_CANDIDATES", 60)
    asked = []
    original = _structure.sphere_overlaps
    monkeypatch.setattr(_structure, "sphere_overlaps", lambda *given: asked.append(original(*given)) or asked[-1])
    points = np.concatenate([np.zeros((20, 3)), np.random.default_rng(3).normal(size=(500, 3))])
    _, distances, _ = proximity.closest_point(ball, points)
    assert len(asked) > 5 and max(len(lists.elements) for lists in asked) <= 60
    naive = trimesh.proximity.closest_point_naive(ball, points)[1]
    assert np.abs(distances - naive).max() < 1e-15 * 10


def test_the_triangle_that_faces_the_point_is_returned():
    ball = trimesh.creation.icosphere(subdivisions=2)
    _, _, triangles = proximity.closest_point(ball, 2 * ball.vertices)
    facing = np.einsum("ij,ij->i", ball.face_normals[triangles], ball.vertices)
    best = np.array([np.dot(ball.face_normals[faces[faces >= 0]], v).max() for faces, v in zip(ball.vertex_faces, ball.vertices)])
    np.testing.assert_allclose(facing, best, atol=1e-12)


def test_signed_distances_of_a_box():
    box = trimesh.creation.box(extents=[2, 2, 2])
    rng = np.random.default_rng(4)
    points = rng.uniform(-2, 2, (3000, 3))
    points[:300] = np.round(points[:300])  # on and above faces, edges and corners
    expected = box_distance(points, 1.0)
    distances = proximity.signed_distance(box, points)
    np.testing.assert_allclose(distances, expected, atol=1e-14)
    assert (distances[expected == 0] == 0).all()
    near = np.array([[0.3, 0.2, 1 - 1e-12], [0.3, 0.2, 1 + 2e-8], [1 - 2e-8, 0.1, 0.2]])  # float32 rounds these to the surface
    np.testing.assert_allclose(proximity.signed_distance(box, near), [1e-12, -2e-8, 2e-8], atol=1e-15)


def test_signs_of_round_and_open_meshes():
    rng = np.random.default_rng(5)
    ball = trimesh.creation.icosphere(subdivisions=2)
    notched = trimesh.Trimesh(ball.vertices, ball.faces[3:], process=False)
    points = rng.normal(size=(600, 3))
    points = points[np.abs(np.linalg.norm(points, axis=1) - 1) > 0.1]
    for mesh in (ball, notched, ball.copy().apply_scale(1e-3).apply_translation([1e3, 0, 0])):
        given = points * mesh.scale / ball.scale + mesh.bounds.mean(axis=0)
        assert ((proximity.signed_distance(mesh, given) > 0) == (np.linalg.norm(points, axis=1) < 1)).all()


def test_signs_are_those_of_trimesh():
    pytest.importorskip("rtree")  # which trimesh's own nearest points need
    ball, points = trimesh.creation.icosphere(subdivisions=2), np.random.default_rng(6).normal(size=(600, 3))
    np.testing.assert_allclose(proximity.signed_distance(ball, points), trimesh.proximity.signed_distance(ball, points), atol=1e-14)


def test_thickness_and_spheres():
    slab = trimesh.creation.box(extents=[8, 8, 1])
    points = np.array([[0.5, 0.2, 0.5], [-1, 1, 0.5]])
    np.testing.assert_allclose(proximity.thickness(slab, points, method="ray"), 1)
    np.testing.assert_allclose(proximity.thickness(slab, points), 1, atol=1e-6)
    assert np.isinf(proximity.thickness(slab, points, exterior=True, method="ray")).all()
    centers, radii = proximity.max_tangent_sphere(slab, points)
    np.testing.assert_allclose(centers, points - [0, 0, 0.5], atol=1e-6)
    np.testing.assert_allclose(radii, 0.5, atol=1e-6)
    np.testing.assert_allclose(proximity.longest_ray(slab, [[0, 0, 3], [0, 0, 3]], [[0, 0, -2], [0, 0, 1]]), [2.5, np.inf])


def test_query_objects():
    box = trimesh.creation.box()
    query = proximity.ProximityQuery(box)
    closest, distance, triangle = query.on_surface([[0.1, 0.2, 2]])
    np.testing.assert_allclose(closest, [[0.1, 0.2, 0.5]])
    assert distance == [1.5] and box.face_normals[triangle].tolist() == [[0, 0, 1]]
    assert query.signed_distance([[0, 0, 0.4]]) == pytest.approx([0.1])
    distance, vertex = query.vertex([[1, 1, 1]])
    assert box.vertices[vertex].tolist() == [[0.5, 0.5, 0.5]] and distance == pytest.approx([0.75**0.5])
    box.apply_translation([0, 0, 9])
    for other in (query, copy.deepcopy(query), pickle.loads(pickle.dumps(query))):
        assert other.on_surface([[0.1, 0.2, 2]])[1] == pytest.approx([6.5])
    box.ray = RayMeshIntersector(box)
    assert proximity.ProximityQuery(box)._engine is box.ray  # one structure for both


def test_empty_and_wrong_arguments():
    box = trimesh.creation.box()
    closest, distances, triangles = proximity.closest_point(box, np.zeros((0, 3)))
    assert closest.shape == (0, 3) and distances.shape == triangles.shape == (0,)
    assert proximity.signed_distance(box, np.zeros((0, 3))).shape == (0,)
    for name, call in (("mesh", lambda: proximity.closest_point("box", [[0, 0, 0]])),
                       ("mesh", lambda: proximity.closest_point(trimesh.Trimesh(), [[0, 0, 0]])),
                       ("points", lambda: proximity.closest_point(box, [0, 0, 0])),
                       ("points", lambda: proximity.signed_distance(box, [[0, np.nan, 0]])),
                       ("points", lambda: proximity.closest_point(box, [[0, 1e300, 0]])),
                       ("normals", lambda: proximity.thickness(box, [[0, 0, 0.5]], normals=[[0, 1]])),
                       ("method", lambda: proximity.thickness(box, [[0, 0, 0.5]], method="guess")),
                       ("directions", lambda: proximity.longest_ray(box, [[0, 0, 0]], [[0, 0, 1]] * 2))):
        with pytest.raises(claray.UsageError, match=f"^{name}: "):
            call()


def test_install_covers_rays_and_points(monkeypatch):
    engines = [trimesh.ray.ray_triangle, *([trimesh.ray.ray_pyembree] if trimesh.ray.has_embree else [])]
    for module, name in ([(engine, "RayMeshIntersector") for engine in engines] +
                         [(trimesh.proximity, "closest_point"), (trimesh.proximity, "signed_distance")]):
        monkeypatch.setattr(module, name, getattr(module, name))  # which puts them back behind the test
    before = trimesh.creation.box()
    install()
    after = trimesh.creation.box()
    assert type(after.ray) is RayMeshIntersector
    asked = []
    original = RayMeshIntersector.nearest
    monkeypatch.setattr(RayMeshIntersector, "nearest", lambda self, points: asked.append(points) or original(self, points))
    for mesh in (before, after):
        assert mesh.nearest.on_surface([[0, 0, 2]])[1] == [1.5]
        assert mesh.nearest.signed_distance([[0, 0, 0.25]]) == [0.25]
    assert trimesh.proximity.thickness(after, [[0.1, 0.2, 0.5]]) == pytest.approx([0.6], abs=1e-4)  # the side at y = 0.5
    assert len(asked) >= 6
