"""claray.trimesh against closed forms, and against trimesh's own engine. bench/python/trimesh_suite.py runs trimesh's tests."""

import copy
import pickle

import numpy as np
import pytest

trimesh = pytest.importorskip("trimesh")

import claray  # noqa: E402
from claray.trimesh import RayMeshIntersector  # noqa: E402


@pytest.fixture(scope="module")
def nested():
    """A sphere of radius 1 in one of radius 2, far from the origin and small: what float32 alone would lose."""
    mesh = trimesh.util.concatenate([trimesh.creation.icosphere(subdivisions=3, radius=r) for r in (1, 2)])
    mesh.apply_scale(1e-3)
    mesh.apply_translation([1e4, -2e4, 3e4])
    return mesh


def test_all_hits_in_order(nested):
    own = RayMeshIntersector(nested)
    rng = np.random.default_rng(3)
    directions = rng.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    centre = nested.bounds.mean(axis=0)
    locations, rays, triangles = own.intersects_location(centre - 5e-3 * directions, directions)
    assert (np.bincount(rays, minlength=200) == 4).all()
    radii = np.linalg.norm(locations - centre, axis=1)
    order = np.argsort(rays, kind="stable")
    assert np.allclose(radii[order].reshape(200, 4), [2e-3, 1e-3, 1e-3, 2e-3], rtol=2e-2)
    along = np.einsum("ij,ij->i", locations - centre, directions[rays])[order].reshape(200, 4)
    assert (np.diff(along) > 0).all()
    plane = np.einsum("ij,ij->i", nested.face_normals[triangles], locations - nested.triangles[triangles, 0])
    assert np.abs(plane).max() < 1e-10
    assert len(own.intersects_id(centre - 5e-3 * directions, directions, max_hits=2)[0]) == 400


def test_first_any_and_containment(nested):
    own = RayMeshIntersector(nested)
    centre = nested.bounds.mean(axis=0)
    points = centre + np.outer([0.5e-3, 1.5e-3, 2.5e-3], [1, 0.1, 0.2])
    assert (own.contains_points(points) == [False, True, False]).all()  # the inner sphere is a hole
    first = own.intersects_first(points, np.tile([1, 0.1, 0.2], (3, 1)))
    assert (first >= 0).tolist() == [True, True, False]
    assert (own.intersects_any(points, np.tile([1, 0.1, 0.2], (3, 1))) == (first >= 0)).all()
    assert own.intersects_first(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)


def test_surfaces_at_one_distance_count_each():
    box = trimesh.creation.box()
    own = RayMeshIntersector(trimesh.util.concatenate([box, box]))
    triangles, rays = own.intersects_id([[0.1, 0.2, 5], [0, 0, 5]], [[0, 0, -1]] * 2)  # the second through diagonals
    assert rays.tolist() == [0, 1] * 4 and len(set(triangles[rays == 0])) == 4


def test_rays_vote_where_a_mesh_is_open():
    box = trimesh.creation.box().subdivide().subdivide()
    point = [[0.1, 0.05, 0]]
    above, _ = RayMeshIntersector(box).intersects_id(point, [[0, 0, 1]])
    hole = trimesh.Trimesh(box.vertices, np.delete(box.faces, above, axis=0))
    assert not hole.is_watertight and RayMeshIntersector(hole).contains_points(point).all()


def test_rays_on_surfaces_and_silhouettes():
    box = trimesh.creation.box(extents=[2, 2, 2])
    own = RayMeshIntersector(box)
    down = np.tile([0.0, 0, -1], (9, 1))
    touching = np.array([[x, y, 5] for x in (-1, 0, 1) for y in (-1, 0, 1)], float)
    assert own.intersects_any(touching, down).all()
    triangles, _ = own.intersects_id([[0.3, 0.1, 1]], [[0, 0, -1]])  # from the surface itself
    assert len(triangles) == 2
    assert not own.intersects_any([[0.3, 0.1, 1 + 1e-5]], [[0, 0, 1]]).any()


def sheet(n):
    """A square of n x n squares of size 1, in the plane z = 0."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    corner = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3)])
    return trimesh.Trimesh(np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]), faces, process=False)


def test_hits_on_borders_are_kept_once():
    """Rays at every corner of a sheet, also of one behind another, from both sides."""
    mesh = sheet(12)
    behind = trimesh.util.concatenate([mesh, mesh.copy().apply_translation([0, 0, -1]), mesh.copy().apply_translation([3, 3, -2])])
    for z, towards in ((5.0, -1.0), (-5.0, 1.0)):
        origins, directions = mesh.vertices + [0, 0, z], np.tile([0, 0, towards], (len(mesh.vertices), 1))
        own = RayMeshIntersector(mesh)
        locations, rays, _ = own.intersects_location(origins, directions)
        assert sorted(rays) == list(range(169)) and own.intersects_any(origins, directions).all()
        np.testing.assert_allclose(locations[np.argsort(rays)], mesh.vertices, atol=1e-12)
        _, rays, triangles = RayMeshIntersector(behind).intersects_location(origins, directions)
        both = (mesh.vertices[:, :2] >= 3).all(axis=1)
        assert (np.bincount(rays, minlength=169) == 2 + both).all()
        assert (np.bincount(rays[triangles < len(mesh.faces)], minlength=169) == 1).all()


def test_every_ray_that_hits_anything_has_a_location():
    """Through corners and edges, which rays touch from all sides."""
    box = trimesh.creation.box(extents=[2, 2, 2]).subdivide()
    targets = np.concatenate([box.vertices, box.vertices[box.edges_unique].mean(axis=1)])
    for direction in ([0, 0, -1], [1, 0, 0], [0, 1, 0], [1, 1, 0], [1, -1, 0], [1, 1, 1], [2, -1, 1]):
        directions = np.tile(np.array(direction, float), (len(targets), 1))
        own = RayMeshIntersector(box)
        hit = own.intersects_any(targets - 4 * directions, directions)
        _, rays, triangles = own.intersects_location(targets - 4 * directions, directions)
        counts = np.bincount(rays, minlength=len(targets))
        assert ((counts > 0) == hit).all() and hit.sum() > len(targets) / 4 and counts.max() <= 2
        first = own.intersects_first(targets - 4 * directions, directions)
        assert ((first >= 0) == hit).all()


def test_far_pieces_spoil_nothing():
    ball = trimesh.creation.icosphere(subdivisions=3)
    rng = np.random.default_rng(7)
    directions = rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for places in ([[0, 0, 0], [1e7, 0, 0]], [[0, 0, 0], [1e9, 1e9, -1e9]], [[0, 0, 0], [1e7, 0, 0], [0, 1e8, 0], [-1e9, 0, 3]],
                   [[5e6, 4e6, 0], [0, 0, 0], [5, 0, 0]]):
        own = RayMeshIntersector(trimesh.util.concatenate([ball.copy().apply_translation(p) for p in places]))
        for number, place in enumerate(np.array(places, float)):
            origins = place - 1.5 * directions
            locations, rays, triangles = own.intersects_location(origins, directions)
            near = triangles // len(ball.faces) == number
            assert (np.bincount(rays[near], minlength=300) == 2).all()
            radii = np.linalg.norm(locations[near] - place, axis=1)
            assert 0.99 < radii.min() and radii.max() < 1.001
            assert (own.intersects_first(origins, directions) // len(ball.faces) == number).all()
            assert own.contains_points([place, place + [0, 0, 1.5]]).tolist() == [True, False]


def test_hits_of_several_pieces_are_in_order():
    """A ray through small balls at distances of 0, 1e4 and 1e6, and past one beside it."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    at = [[0, 0, 0], [1e4, 0, 0], [1e6, 0, 0], [1e4, 1e5, 0]]
    own = RayMeshIntersector(trimesh.util.concatenate([ball.copy().apply_translation(p) for p in at]))
    triangles, rays = own.intersects_id([[2e6, 0.1, 0.2], [-5, 0.1, 0.2]], [[-1, 0, 0], [1, 0, 0]])
    pieces = triangles // len(ball.faces)
    assert pieces[rays == 0].tolist() == [2, 2, 1, 1, 0, 0] and pieces[rays == 1].tolist() == [0, 0, 1, 1, 2, 2]
    assert len(own.intersects_id([[-5, 0.1, 0.2]], [[1, 0, 0]], max_hits=3)[0]) == 3


def test_meshes_change_and_are_copied(nested):
    mesh = trimesh.creation.box()
    own = RayMeshIntersector(mesh)
    assert own.intersects_any([[0, 0, 5]], [[0, 0, -1]]).all()
    mesh.apply_translation([9, 0, 0])
    assert not own.intersects_any([[0, 0, 5]], [[0, 0, -1]]).any()
    for other in (copy.copy(own), copy.deepcopy(own), pickle.loads(pickle.dumps(own))):
        assert other.intersects_any([[9, 0, 5]], [[0, 0, -1]]).all()
    with pytest.raises(claray.UsageError, match="^ray_directions"):
        own.intersects_first(np.zeros((2, 3)), np.zeros((3, 3)))


def test_rays_within_a_small_part_of_a_large_mesh():
    """Rays begin a little back, so that they hit what they begin on; but not so far that they leave a ball of 1e-3 in a room of 8192."""
    ball = trimesh.creation.icosphere(subdivisions=1, radius=2.0**-10)
    ball.vertices = ball.vertices.astype(np.float32)
    room = trimesh.creation.box(extents=[2.0**14] * 3)
    own = RayMeshIntersector(trimesh.util.concatenate([room, ball]))
    directions = np.random.default_rng(9).normal(size=(200, 3))
    locations, rays, triangles = own.intersects_location(np.zeros((200, 3)), directions, multiple_hits=False)
    assert len(rays) == 200 and (triangles >= len(room.faces)).all()
    assert (np.einsum("ij,ij->i", locations, directions) > 0).all()  # in front of the origin
