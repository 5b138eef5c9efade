"""claray.open3d against closed forms, and against Open3D where it is installed. bench/python/open3d_suite.py runs Open3D's tests."""

import numpy as np
import pytest

import claray
from claray.open3d import RaycastingScene

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                  [1, 5, 7], [1, 7, 3]], np.uint32)


def scene_of(*meshes):
    scene = RaycastingScene()
    assert [scene.add_triangles(*mesh) for mesh in meshes] == list(range(len(meshes)))
    return scene


def box(low=0.0, high=1.0):
    """Faces look outwards."""
    return CORNERS * np.float32(high - low) + np.float32(low), FACES


def distance_to_box(points, low=0.0, high=1.0):
    beyond = np.abs(points - (low + high) / 2) - (high - low) / 2
    return np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0)


@pytest.fixture(scope="module")
def boxes():
    """A box of 0 to 1, nothing, and a box of 3 to 4."""
    return scene_of(box(), (CORNERS[:0], FACES[:0]), box(3, 4))


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(1)
    return (rng.uniform(-0.3, 1.3, (7, 31, 3)) + 3 * rng.integers(0, 2, (7, 31, 1))).astype(np.float32)


def test_first_hits(boxes):
    rng = np.random.default_rng(2)
    inside = rng.uniform(0.01, 0.99, (5, 41, 3)) + 3.0 * rng.integers(0, 2, (5, 41, 1))
    directions = rng.normal(size=inside.shape)
    rays = np.concatenate([inside, 3 * directions], axis=-1).astype(np.float32)
    far = rays.astype(np.float64)
    walls = np.where(far[..., 3:] > 0, 1, 0) + 3 * (far[..., :1] > 2)
    along = (walls - far[..., :3]) / far[..., 3:]
    answers = boxes.cast_rays(rays)
    assert {name: (array.dtype.name, array.shape[2:]) for name, array in answers.items()} == {
        "t_hit": ("float32", ()), "geometry_ids": ("uint32", ()), "primitive_ids": ("uint32", ()),
        "primitive_uvs": ("float32", (2,)), "primitive_normals": ("float32", (3,))}
    assert np.allclose(answers["t_hit"], along.min(axis=-1), rtol=1e-4)
    assert (answers["geometry_ids"] == np.where(far[..., 0] > 2, 2, 0)).all()
    axis = np.eye(3)[along.argmin(axis=-1)]
    assert (answers["primitive_normals"] == axis * np.sign(far[..., 3:])).all()  # outwards
    corners = CORNERS[FACES[answers["primitive_ids"]]] + 3 * (far[..., 0] > 2)[..., None, None]
    u, v = np.moveaxis(answers["primitive_uvs"], -1, 0)[..., None]
    places = (1 - u - v) * corners[..., 0, :] + u * corners[..., 1, :] + v * corners[..., 2, :]
    assert np.allclose(places, far[..., :3] + far[..., 3:] * answers["t_hit"][..., None], atol=1e-5)


def test_misses(boxes):
    answers = boxes.cast_rays([[9, 9, 9, 1, 0, 0], [0.5, 0.5, np.nan, 0, 0, 1]])
    assert (answers["t_hit"] == np.inf).all() and not answers["primitive_normals"].any() and not answers["primitive_uvs"].any()
    assert (answers["geometry_ids"] == boxes.INVALID_ID).all() and (answers["primitive_ids"] == RaycastingScene.INVALID_ID).all()


def test_occlusion_between(boxes):
    rays = np.array([[0.5, 0.4, -1, 0, 0, 2], [9, 9, 9, 1, 0, 0]], np.float32)
    for limits, found in (({}, True), ({"tfar": 0.4}, False), ({"tfar": 0.6}, True), ({"tnear": 0.6, "tfar": 0.9}, False), ({"tnear": 1.1}, False)):
        hit = boxes.test_occlusions(rays, **limits)
        assert hit.dtype == bool and hit.tolist() == [found, False]


def test_all_hits_count_edges_once(boxes):
    rays = np.array([[[0.5, 0.5, -2, 0, 0, 1], [-1, -1, -1, 1, 1, 1]], [[0.25, 0.5, 0.5, 0, 0, 2], [9, 9, 9, 1, 0, 0]]], np.float32)
    counts = boxes.count_intersections(rays)
    assert counts.dtype == np.int32 and counts.tolist() == [[2, 4], [1, 0]]  # through diagonals and corners of boxes
    found = boxes.list_intersections(rays)
    assert found["ray_splits"].tolist() == [0, 2, 6, 7, 7] and found["ray_ids"].tolist() == [0, 0, 1, 1, 1, 1, 2]
    assert found["t_hit"].tolist() == [2, 3, 1, 2, 4, 5, 0.25]
    assert found["geometry_ids"].tolist() == [0, 0, 0, 0, 2, 2, 0]
    assert found["primitive_ids"].max() < 12 and found["primitive_uvs"].shape == (7, 2)


def test_points(boxes, points):
    distances = np.stack([distance_to_box(points), distance_to_box(points, 3, 4)])
    nearer, inside = np.abs(distances).argmin(axis=0), (distances < 0).any(axis=0)
    assert 20 < inside.sum() < 180
    near = boxes.compute_closest_points(points)
    assert (near["geometry_ids"] == 2 * nearer).all() and near["points"].shape == points.shape
    exact = np.abs(distances).min(axis=0)
    assert np.allclose(np.linalg.norm(near["points"] - points, axis=-1), exact, atol=1e-5)
    outwards = np.einsum("...i,...i", near["primitive_normals"], near["points"] - points)
    assert np.allclose(outwards[inside], exact[inside], atol=1e-6) and (outwards[~inside] < 1e-6).all()
    assert np.allclose(boxes.compute_distance(points), exact, atol=1e-6)
    assert np.allclose(boxes.compute_signed_distance(points), np.where(inside, -exact, exact), atol=1e-6)
    occupancy = boxes.compute_occupancy(points)
    assert occupancy.dtype == np.float32 and (occupancy == inside).all()
    assert (boxes.compute_occupancy(points, nsamples=3) == inside).all()


def test_samples_vote_where_a_mesh_is_open():
    """A triangle is met by Open3D's first direction only, and a ring around it by the second and the third."""
    towards = claray.open3d._directions(3).astype(np.float64)
    assert np.isclose(towards[0, 0], 1 + 0.001 * (2 * 1608637542 / 2**32 - 1), rtol=1e-7)  # the first number of std::mt19937(42)
    assert (np.abs(towards - 1) <= 0.001).all() and len(np.unique(towards, axis=0)) == 3
    patch = (10 / towards[0].sum() * towards[0] + 1e-4 * np.array([[1, -1, 0], [-1, 0, 1], [0, 1, -1]])).astype(np.float32)
    outer = np.diag(np.float32([10, 10, 10]))
    ring = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
    for corners, faces, answers in ((outer, [[0, 1, 2]], [1, 1]), (patch, [[0, 1, 2]], [1, 0]), (np.concatenate([outer, patch]), ring, [0, 1])):
        assert [scene_of((corners, faces)).compute_occupancy([[0, 0, 0]], nsamples=n)[0] for n in (1, 3)] == answers


def test_pinhole_cameras():
    intrinsic = np.array([[200.0, 0, 33], [0, 210, 17], [0, 0, 1]])
    angle = 0.3
    extrinsic = np.eye(4)
    extrinsic[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    extrinsic[:3, 3] = 1, 2, 3
    rays = RaycastingScene.create_rays_pinhole(intrinsic, extrinsic, width_px=64, height_px=40)
    assert rays.shape == (40, 64, 6) and rays.dtype == np.float32
    places = rays[..., :3] + 2.5 * rays[..., 3:].astype(np.float64)
    seen = (places @ extrinsic[:3, :3].T + extrinsic[:3, 3]) @ intrinsic.T
    pixels = seen[..., :2] / seen[..., 2:]
    assert np.allclose(pixels, np.stack(np.meshgrid(np.arange(64) + 0.5, np.arange(40) + 0.5), axis=-1), atol=1e-3)

    rays = RaycastingScene.create_rays_pinhole(fov_deg=90, center=[0, 0, 0], eye=[0, 0, -5], up=[0, 1, 0], width_px=4, height_px=2)
    assert (rays[..., :3] == [0, 0, -5]).all()
    assert np.allclose(rays[0, :, 3:], [[(x - 1.5) / 2, -0.25, 1] for x in range(4)])  # up grows with the row, as in Open3D


def test_scenes_grow_and_copy():
    corners = box()[0]
    scene = scene_of((corners, FACES))
    ray = np.array([[0.5, 0.4, 9, 0, 0, -1]], np.float32)
    assert scene.cast_rays(ray)["t_hit"] == 8
    corners += 100
    scene.add_triangles(*box(3, 4))
    assert scene.cast_rays(ray)["t_hit"] == 8 and scene.cast_rays(ray + [3, 3, 0, 0, 0, 0])["geometry_ids"] == 1


def test_empty_scenes():
    for scene in (RaycastingScene(device="CPU:0"), scene_of((np.zeros((0, 3)), np.zeros((0, 3), int)))):
        assert scene.cast_rays(np.ones((2, 6)))["t_hit"].tolist() == [np.inf] * 2
        assert scene.count_intersections(np.ones((2, 6))).tolist() == [0, 0] and len(scene.list_intersections(np.ones((2, 6)))["t_hit"]) == 0
        assert scene.compute_distance(np.ones((2, 3))).tolist() == [np.inf] * 2
    assert scene_of(box()).cast_rays(np.zeros((0, 6)))["t_hit"].shape == (0,)


class Tensor:
    """What claray uses of open3d.core.Tensor."""

    def __init__(self, array):
        self.array = np.asarray(array)

    @classmethod
    def from_numpy(cls, array):
        assert array.flags.c_contiguous
        return cls(array)

    def numpy(self):
        if self.array.dtype == np.float16:
            raise RuntimeError("not on the CPU")
        return self.array


class Device:
    """What claray uses of open3d.core.Device."""

    def __init__(self, name):
        self.name = name

    def get_type(self):
        return None

    def __str__(self):
        return self.name


class Mesh:
    """What claray uses of open3d.t.geometry.TriangleMesh."""

    vertex, triangle = {"positions": Tensor(CORNERS)}, {"indices": Tensor(FACES.astype(np.int64))}


def test_results_are_what_arguments_are():
    scene = RaycastingScene(nthreads=2, device=Device("CPU:0"))
    assert scene.add_triangles(Mesh()) == 0 and scene.add_triangles(mesh=Mesh()) == 1
    ray = np.array([[0.5, 0.4, 9, 0, 0, -1]], np.float32)
    for ask in (scene.cast_rays, scene.list_intersections):
        assert {type(value) for value in ask(Tensor(ray)).values()} == {Tensor}
    assert type(scene.compute_signed_distance(Tensor(ray[:, :3]))) is Tensor
    assert type(RaycastingScene.create_rays_pinhole(60, Tensor([0, 0, 1]), [0, 0, 0], [0, 1, 0], 2, 2)) is Tensor
    found = scene.cast_rays(ray, nthreads=1)["t_hit"]
    assert isinstance(found, np.ndarray) and type(found.cpu().numpy()) is np.ndarray and found.numpy() == 8


@pytest.mark.parametrize("name, call", [
    ("device", lambda s: RaycastingScene(device=Device("CUDA:0"))),
    ("rays", lambda s: s.cast_rays(np.zeros((3, 5)))),
    ("rays", lambda s: s.test_occlusions(np.zeros(6))),
    ("rays", lambda s: s.cast_rays(Tensor(np.zeros((3, 6), np.float16)))),
    ("tnear", lambda s: s.test_occlusions(np.zeros((3, 6)), tnear=-1)),
    ("query_points", lambda s: s.compute_distance([["a", "b", "c"]])),
    ("nsamples", lambda s: s.compute_occupancy(np.zeros((3, 3)), nsamples=2)),
    ("triangle_indices", lambda s: s.add_triangles(CORNERS, [[0, 1, 8]])),
    ("vertex_positions", lambda s: s.add_triangles(CORNERS[:, :2], FACES)),
    ("mesh", lambda s: s.add_triangles(CORNERS)),
    ("intrinsic_matrix", lambda s: s.create_rays_pinhole(np.zeros((3, 3)), np.eye(4), 4, 4)),
    ("extrinsic_matrix", lambda s: s.create_rays_pinhole(np.eye(3), np.eye(3), 4, 4)),
    ("up", lambda s: s.create_rays_pinhole(60, [0, 0, 1], [0, 0, 0], [0, 0, 1], 4, 4)),
])
def test_errors_name_the_argument(boxes, name, call):
    with pytest.raises(claray.UsageError, match=f"^{name}: "):
        call(boxes)


def test_against_open3d(soup, points):
    o3d = pytest.importorskip("open3d")
    vertices, triangles, _ = soup
    meshes = [(vertices, triangles[:100].astype(np.uint32)), (vertices, triangles[100:].astype(np.uint32))]
    own, peer = scene_of(*meshes), o3d.t.geometry.RaycastingScene()
    for mesh in meshes:
        peer.add_triangles(*mesh)
    rng = np.random.default_rng(4)
    rays = o3d.core.Tensor(np.concatenate([rng.uniform(-2, 2, (9, 99, 3)), rng.normal(size=(9, 99, 3))], axis=-1).astype(np.float32))
    ours, theirs = own.cast_rays(rays), peer.cast_rays(rays)
    assert ours.keys() == theirs.keys()
    for name in theirs:
        assert type(ours[name]) is o3d.core.Tensor and ours[name].dtype == theirs[name].dtype
        assert np.allclose(ours[name].numpy(), theirs[name].numpy(), rtol=1e-4, atol=1e-4), name
    assert (own.count_intersections(rays).numpy() == peer.count_intersections(rays).numpy()).all()
    assert (own.test_occlusions(rays, 0.1, 0.5).numpy() == peer.test_occlusions(rays, 0.1, 0.5).numpy()).all()
    ours, theirs = own.list_intersections(rays), peer.list_intersections(rays)
    assert ours.keys() == theirs.keys() and (ours["ray_splits"].numpy() == theirs["ray_splits"].numpy()).all()
    assert np.allclose(ours["t_hit"].numpy()[np.lexsort((ours["t_hit"].numpy(), ours["ray_ids"].numpy()))],
                       theirs["t_hit"].numpy()[np.lexsort((theirs["t_hit"].numpy(), theirs["ray_ids"].numpy()))], rtol=1e-4)
    near, peers = own.compute_closest_points(points), peer.compute_closest_points(points)
    assert np.allclose(near["points"], peers["points"].numpy(), atol=1e-5) and near.keys() == peers.keys()
    for samples in (1, 5):  # of an open mesh, so that the directions matter
        assert (own.compute_occupancy(points / 3, nsamples=samples) == peer.compute_occupancy(points / 3, nsamples=samples).numpy()).all()
    view = dict(fov_deg=70, center=[0, 0.5, 0], eye=[2, 1, 3], up=[0, 1, 0.2], width_px=31, height_px=17)
    assert np.allclose(own.create_rays_pinhole(**view), peer.create_rays_pinhole(**view).numpy(), atol=1e-6)
