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
