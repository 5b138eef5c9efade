"""claray.warp against closed forms and float64 brute force, and against Warp where it is installed."""

import numpy as np
import pytest

import claray
from claray import warp

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                  [1, 5, 7], [1, 7, 3]], np.int32)
SIGNS = [warp.mesh_query_point, warp.mesh_query_point_sign_normal, warp.mesh_query_point_sign_parity,
         warp.mesh_query_point_sign_winding_number]


def solid_angles(corners, points):
    """In turns, summed over all triangles: by the angles of spherical triangles (Girard), which warp.py does not use."""
    to = corners[None] - points[:, None, None]
    a, b, c = np.moveaxis(to / np.linalg.norm(to, axis=-1, keepdims=True), 2, 0)
    def dihedral(p, q, r):
        across, other = np.cross(p, q), np.cross(p, r)
        return np.arctan2(np.linalg.norm(np.cross(across, other), axis=-1), np.einsum("...i,...i", across, other))
    excess = dihedral(a, b, c) + dihedral(b, c, a) + dihedral(c, a, b) - np.pi
    return (excess * np.sign(np.einsum("...i,...i", a, np.cross(b, c)))).sum(axis=1) / (4 * np.pi)


@pytest.fixture(scope="module")
def box():
    return warp.Mesh(CORNERS, FACES.ravel(), support_winding_number=True)


@pytest.fixture(scope="module")
def star():
    """A closed surface of sharp edges and corners: the corners of an octahedron that is divided twice, pulled out and in by turns."""
    corners, faces = np.concatenate([np.eye(3), -np.eye(3)]), np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]])
    faces = np.concatenate([faces, np.where(faces == 2, 5, faces)[:, ::-1]])
    for _ in range(2):
        middles = corners[faces] + corners[np.roll(faces, -1, axis=1)]
        triangles = corners[faces]
        triangles = np.concatenate([middles] + [np.stack([triangles[:, k], middles[:, k], middles[:, k - 1]], axis=1) for k in range(3)])
        triangles /= np.linalg.norm(triangles, axis=-1, keepdims=True)
        corners, faces = np.unique(triangles.round(9).reshape(-1, 3), axis=0, return_inverse=True)
        faces = faces.reshape(-1, 3)
    corners *= np.where(np.arange(len(corners)) % 2, 1.0, 0.4)[:, None]
    return warp.Mesh(corners.astype(np.float32), faces, support_winding_number=True)


def test_rays_against_brute_force(soup, rays):
    vertices, triangles, _ = soup
    origins, directions = (array.astype(np.float64) for array in rays)
    a, b, c = np.moveaxis(vertices.astype(np.float64)[triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    along = directions @ normals.T
    t = np.einsum("ti,nti->nt", normals, a - origins[:, None]) / along
    at = origins[:, None] + t[..., None] * directions[:, None]
    weights = np.stack([np.einsum("ti,nti->nt", normals, np.cross(r - q, at - q)) for p, q, r in ((a, b, c), (b, c, a))])
    weights /= np.einsum("ti,ti->t", normals, normals)
    most = np.where(np.arange(777) % 2, 0.9, 1e30)
    t = np.where((weights >= 0).all(axis=0) & (weights.sum(axis=0) <= 1) & (t >= 0) & (t < most[:, None]), t, np.inf)
    face = t.argmin(axis=1)
    hit = np.isfinite(t.min(axis=1))
    assert 50 < hit.sum() < 700

    mesh = warp.Mesh(vertices, triangles.ravel())
    found = warp.mesh_query_ray(mesh, *rays, most)
    assert (found.result == hit).all() and found.result.dtype == bool and found.face.dtype == np.int32
    assert (found.face[hit] == face[hit]).all() and np.allclose(found.t[hit], t.min(axis=1)[hit], rtol=1e-4)
    u, v = (weights[k][hit, face[hit]] for k in (0, 1))
    assert np.allclose(found.u[hit], u, atol=1e-3) and np.allclose(found.v[hit], v, atol=1e-3)
    assert (found.sign[hit] == -np.sign(along[hit, face[hit]])).all()
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.allclose(found.normal[hit], unit[face[hit]], atol=1e-5)
    places = warp.mesh_eval_position(mesh, found.face, found.u, found.v)
    assert np.allclose(places[hit], (rays[0] + found.t[:, None] * rays[1])[hit], atol=1e-4)
    for numbers in found:
        assert not numbers[~hit].any()
    assert (warp.mesh_query_ray_anyhit(mesh, *rays, most) == hit).all()


def test_shapes_limits_and_counts(box):
    start = np.array([[[0.5, 0.5, -2], [-1, -1, -1]], [[0.25, 0.5, 0.5], [9, np.nan, 9]]], np.float32)
    towards = np.array([[[0, 0, 2], [1, 1, 1]], [[0, 0, 2], [1, 0, 0]]], np.float32)
    found = warp.mesh_query_ray(box, start, towards, np.inf)
    assert found.t.tolist() == [[1, 1], [0.25, 0]] and found.normal.shape == (2, 2, 3)
    assert found.sign.tolist() == [[1, 1], [-1, 0]]  # from within: behind the face
    counts = warp.mesh_query_ray_count_intersections(box, start, towards)
    assert counts.dtype == np.int32 and counts.tolist() == [[2, 2], [1, 0]]  # through diagonals and corners
    for most, hits in ((0.25, False), (np.nextafter(np.float32(0.25), np.float32(1)), True)):  # must be nearer
        assert warp.mesh_query_ray(box, start, towards, most).result.tolist() == [[False, False], [hits, False]]
        assert warp.mesh_query_ray_anyhit(box, start, towards, most).tolist() == [[False, False], [hits, False]]


@pytest.mark.parametrize("query", [warp.mesh_query_point_no_sign, *SIGNS])
def test_points_of_a_box(box, query):
    points = np.random.default_rng(6).uniform(-1, 2, (4, 99, 3)).astype(np.float32)
    points[0, :64] = CORNERS[np.arange(64) % 8] + 0.25 * np.sign(CORNERS[np.arange(64) // 8] - 0.5)  # corners and edges are nearest
    points[0, 64] = np.nan
    beyond = np.abs(points - 0.5) - 0.5
    distances = np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0)
    near = query(box, points, 0.7)
    assert (near.result == (np.abs(distances) < 0.7)).all() and 100 < near.result.sum() < 390
    places = warp.mesh_eval_position(box, near.face, near.u, near.v)
    assert np.allclose(np.linalg.norm(places - points, axis=-1)[near.result], np.abs(distances)[near.result], atol=1e-6)
    signs = np.where(near.result, np.sign(distances), 0)
    assert (near.sign == (0 if query is warp.mesh_query_point_no_sign else signs)).all()
    assert not near.face[~near.result].any() and not near.u[~near.result].any() and not near.v[~near.result].any()


def test_distances_must_be_smaller(box):
    points = np.array([[0.5, 0.5, 1.5]] * 3, np.float32)
    assert warp.mesh_query_point(box, points, [0.5, 0.6, 0]).result.tolist() == [False, True, False]


def test_signs_at_sharp_edges_and_corners(star):
    """Points around corners, beyond them and between: the plane of the nearest face alone decides wrongly. Winding numbers are of all faces."""
    rng = np.random.default_rng(7)
    corners = star._geometry.corners
    points = (corners[rng.integers(len(corners), size=2000)] * rng.uniform(0.5, 1.5, (2000, 1)) + rng.normal(scale=0.05, size=(2000, 3)))
    points = points.astype(np.float32)
    turns = solid_angles(star._geometry.triangles(slice(None)), points.astype(np.float64))
    assert np.allclose(turns, turns.round(), atol=1e-6) and set(turns.round()) == {0, 1}
    for query in SIGNS:
        assert (query(star, points, np.inf).sign == np.where(turns > 0.5, -1, 1)).all(), query.__name__
    near = warp.mesh_query_point_no_sign(star, points, np.inf)
    flat = np.einsum("ij,ij->i", warp.mesh_eval_face_normal(star, near.face), points - warp.mesh_eval_position(star, near.face, near.u, near.v))
    assert ((flat > 0) != (turns < 0.5)).sum() > 10


def test_pseudonormals_of_corners_and_edges(box):
    """However the sides of a box are divided into triangles, those of its corners are along its diagonals."""
    normals = box._geometry.feature_normals
    outwards = 2 * CORNERS[FACES] - 1
    assert np.allclose(normals[:, [6, 5, 3]], np.pi / 2 * outwards)
    middles = outwards[:, [1, 2, 0]] + outwards[:, [2, 0, 1]]
    assert np.allclose(normals[:, [1, 2, 4]], 2 * middles / np.abs(middles).sum(axis=-1, keepdims=True))


def test_winding_numbers_of_open_and_nested_meshes(star):
    corners, faces = star._geometry.corners, star._geometry.faces
    points = np.random.default_rng(8).uniform(-1, 1, (500, 3)).astype(np.float32)
    inner = np.concatenate([corners, corners / 2])
    for vertices, triangles in ((corners, faces[:70]), (corners, faces[:70, ::-1]), (inner, np.concatenate([faces, faces + len(corners)]))):
        mesh = warp.Mesh(vertices, triangles, support_winding_number=True)
        turns = solid_angles(vertices[triangles].astype(np.float64), points.astype(np.float64))
        assert np.allclose(warp._winding_numbers(mesh, points), turns, atol=1e-6)
        for threshold in (0.3, 0.5, 1.5):
            near = warp.mesh_query_point_sign_winding_number(mesh, points, 9, threshold=threshold)
            assert (near.sign == np.where(turns > threshold, -1, 1)).all()
    assert turns.max() > 1.5
    plain = warp.Mesh(corners, faces[:70])
    assert (warp.mesh_query_point_sign_winding_number(plain, points, 9).sign == warp.mesh_query_point(plain, points, 9).sign).all()


def test_rays_vote_for_signs(box):
    points = np.array([[0.5, 0.5, 0.5]], np.float32)
    lidless = warp.Mesh(CORNERS, FACES[:10])  # without the face at z = 1
    assert warp.mesh_query_point(lidless, points, 9).sign == -1  # two of three rays
    wall = warp.Mesh(CORNERS, np.concatenate([FACES[2:4], FACES[6:8, ::-1]]))  # one ray from behind, one from the front
    assert warp.mesh_query_point(wall, points, 9).sign == 1
    points = np.array([[0.5, 0.5, 0.4], [0.5, 0.5, 0.55]], np.float32)
    odd = {}
    for scale in (0.1, 0.9):
        directions = warp._directions(8, scale)
        assert (np.abs(directions - 1) <= scale).all() and np.abs(directions - 1).max() > 0.7 * scale
        odd[scale] = np.stack([claray.any_hit(lidless._bvh, points, towards) for towards in directions])
        for count in range(1, 9):  # at least half
            signs = np.where(2 * odd[scale][:count].sum(axis=0) >= count, -1, 1)
            assert (warp.mesh_query_point_sign_parity(lidless, points, 9, count, scale).sign == signs).all()
    assert any((2 * votes[:count].sum(axis=0) == count).any() for votes in odd.values() for count in (2, 4, 6, 8))
    assert (2 * odd[0.1].sum(axis=0) >= 8).tolist() != (2 * odd[0.9].sum(axis=0) >= 8).tolist()


def test_meshes_move():
    points = CORNERS.copy()
    mesh = warp.Mesh(points, FACES)
    start, towards = [[0.5, 0.4, 9.0]], [[0.0, 0.0, -1.0]]
    points *= [1, 1, 3]
    assert warp.mesh_query_ray(mesh, start, towards, 99).t == 8 and warp.mesh_get_point(mesh, [2]).tolist() == [[0, 1, 1]]
    mesh.refit()
    assert warp.mesh_query_ray(mesh, start, towards, 99).t == 6
    mesh.points = CORNERS * [1, -1, 1]
    found = warp.mesh_query_ray(mesh, [[0.5, -0.4, 9.0]], towards, 99)
    assert found.t == 8 and found.normal.tolist() == [[0, 0, -1]] and found.sign == -1  # inside out
    assert warp.mesh_query_point_sign_normal(mesh, [[0.5, -0.4, 0.5]], 9).sign == 1
    with pytest.raises(claray.UsageError, match="^points: "):
        mesh.points = CORNERS[:7]


def test_boxes_spheres_and_lookups(box):
    faces = warp.mesh_query_aabb(box, [[0.4, 0.1, -0.1], [3, 3, 3]], [[0.6, 0.2, 0.1], [4, 4, 4]])
    assert [list(found) for found in faces] == [[8 if CORNERS[FACES[8]][:, 1].mean() < 0.4 else 9], []]
    touched = warp.mesh_query_sphere(box, [[0.5, 0.5, 0.5], [0.9, 0.3, 0.2]], [0.5, 0.15])
    assert touched.counts.tolist() == [12, 2] and (warp.mesh_query_sphere(box, [[0.5, 0.5, 0.5]], -1).counts == 0).all()
    assert warp.mesh_get_index(box, [3, 35]).tolist() == [0, 3]
    assert warp.mesh_get_point(box, [5]).tolist() == [CORNERS[2].tolist()]
    assert warp.mesh_eval_face_normal(box, [2, 10]).tolist() == [[1, 0, 0], [0, 0, 1]]
    assert np.allclose(warp.mesh_eval_position(box, [2], [0.5], [0.25]), [[1, 0.5, 0.25]])


@pytest.mark.parametrize("name, call", [
    ("start", lambda m: warp.mesh_query_ray(m, np.zeros((3, 2)), np.ones((3, 3)), 1)),
    ("dir", lambda m: warp.mesh_query_ray(m, np.zeros((3, 3)), np.ones((2, 3)), 1)),
    ("max_t", lambda m: warp.mesh_query_ray(m, np.zeros((3, 3)), np.ones((3, 3)), [1, 2])),
    ("max_dist", lambda m: warp.mesh_query_point(m, np.zeros((3, 3)), np.nan)),
    ("n_sample", lambda m: warp.mesh_query_point_sign_parity(m, np.zeros((3, 3)), 1, 0)),
    ("n_sample", lambda m: warp.mesh_query_point_sign_parity(m, np.zeros((3, 3)), 1, 10**12)),
    ("mesh", lambda m: warp.mesh_query_point(7, np.zeros((3, 3)), 1)),
    ("mesh", lambda m: warp.mesh_get_point("mesh", [0])),
    ("bary_v", lambda m: warp.mesh_eval_position(m, [0, 1], [0.5, 0.5], [0.5])),
    ("low", lambda m: warp.mesh_query_aabb(m, 1, np.zeros((3, 3)))),
    ("face", lambda m: warp.mesh_eval_face_normal(m, [12])),
    ("index", lambda m: warp.mesh_get_point(m, [-1])),
    ("face_vertex_index", lambda m: warp.mesh_get_index(m, [36])),
    ("indices", lambda m: warp.Mesh(CORNERS, [0, 1, 8])),
    ("indices", lambda m: warp.Mesh(CORNERS, [0, 1, 2, 3])),
    ("indices", lambda m: warp.Mesh(CORNERS, np.zeros(0, int))),
    ("points", lambda m: warp.Mesh(CORNERS[:, :2], FACES)),
    ("velocities", lambda m: warp.Mesh(CORNERS, FACES, velocities=CORNERS)),
    ("groups", lambda m: warp.Mesh(CORNERS, FACES, groups=FACES[:, 0])),
])
def test_errors_name_the_argument(box, name, call):
    with pytest.raises(claray.UsageError, match=f"^{name}: "):
        call(box)


def test_against_warp(soup, rays, star):
    wp = pytest.importorskip("warp")
    from warp_peer import Peer  # kernels must be in a file

    for vertices, triangles in ((soup[0], soup[1]), (star._geometry.corners, star._geometry.faces)):
        peer = Peer(vertices, triangles)
        mesh = warp.Mesh(peer.points, peer.indices, support_winding_number=True)
        start, towards = (wp.array(array, dtype=wp.vec3) for array in rays)
        found, theirs = warp.mesh_query_ray(mesh, start, towards, 1.5), peer.rays(start, towards, 1.5)
        for ours, other in zip(found, theirs):
            assert isinstance(ours, wp.array) and ours.dtype == other.dtype
            assert np.allclose(ours.numpy(), np.sign(other.numpy()) if other is theirs[1] else other.numpy(), rtol=1e-3, atol=1e-4)
        for query in (warp.mesh_query_point_no_sign, *SIGNS):
            near, theirs = query(mesh, start, 0.8), peer.points_by(query.__name__, start, 0.8)
            assert (near.result.numpy() == theirs[0].numpy()).all()
            differ = near.sign.numpy() != theirs[1].numpy()
            assert differ.sum() <= (5 if query is warp.mesh_query_point_sign_normal else 0)  # Warp mixes faces that are nearly as near
            assert np.allclose(mesh_distances(mesh, near, rays[0]), mesh_distances(mesh, theirs, rays[0]), atol=1e-5)


def mesh_distances(mesh, near, points):
    return np.linalg.norm(warp.mesh_eval_position(mesh, *(array.numpy() for array in near[2:])) - points, axis=1)[near[0].numpy()]
