"""Textures, environments, instances, motion and all properties of a scene."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import claray
from test_bad_input import refused

QUAD = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]
UVS = [[0, 1], [1, 1], [1, 0], [0, 0]]


def lit(**properties):
    """An empty scene under a white sky, seen from the front: each convex surface shows its albedo."""
    scene = claray.Scene()
    scene.sky = 1, 1, 1
    scene.add_material(albedo=(1, 1, 1), **properties)
    scene.camera = claray.Camera(position=(0, 0, 9), target=(0, 0, 0), orthographic_height=2)
    return scene


def seen(scene, side=4, **options):
    return np.array(claray.render(scene, width=side, height=side, spp=1, **options))


def test_maps_of_materials_are_seen(tmp_path):
    texels = np.array([[[1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 1, 1]]], np.float32)
    scene = lit(kind="unlit")
    scene.add_mesh(*QUAD, uvs=UVS, uvs1=np.array(UVS)[:, ::-1])
    image = scene.add_texture(claray.Texture(texels, filter="nearest"))
    scene.materials[0].albedo_map = image
    assert scene.materials[0].albedo_map == claray.TextureUse(image)
    assert np.allclose(seen(scene)[[0, 0, 3, 3], [0, 3, 0, 3]], texels.reshape(-1, 3))
    scene.materials[0].albedo_map = claray.TextureUse(image, uv_set=1)
    assert np.allclose(seen(scene)[0, 3], texels[1, 0])
    scene.materials[0].albedo_map = claray.TextureUse(image, offset=(0.5, 0))
    assert np.allclose(seen(scene)[0, 0], texels[0, 1])
    scene.materials[0].albedo_map = None
    assert scene.materials[0].albedo_map is None and np.allclose(seen(scene)[0, 0], 1)

    claray.Texture((255 * texels).astype(np.uint8)).save(tmp_path / "colours.png")
    scene.materials[0].albedo_map = scene.add_texture(str(tmp_path / "colours.png"))
    assert len(scene.textures) == 2 and scene.textures[1].pixels.dtype == np.uint8 and scene.textures[1].color == "srgb"
    assert seen(scene)[0, 0].argmax() == 0
    heights = scene.add_texture(np.zeros((4, 4), np.float32))
    assert scene.textures[heights].pixels.shape == (4, 4, 1)
    normals = scene.textures[heights].normal_map()
    assert normals.color == "linear" and (normals.pixels[..., 2] >= 254).all()
    scene.textures = [scene.textures[1]]
    scene.materials[0].albedo_map = 5
    with pytest.raises(claray.InputError, match="texture 5 of 1"):
        seen(scene)
    refused("albedo_map", lambda: setattr(scene.materials[0], "albedo_map", "wood.png"))
    refused("image", lambda: scene.add_texture(np.zeros((2, 2, 5), np.float32)), "1 to 4")
    refused("image", lambda: scene.add_texture(np.zeros((2, 2), int)), "uint8")
    refused("wrap", lambda: claray.Texture(texels, wrap="tile"), "mirror")
    refused("filter", lambda: claray.Texture(texels, filter="cubic"), "bilinear")
    refused("color", lambda: claray.Texture(texels, "hsv"), "linear")
    with pytest.raises(claray.InputError, match="none.png"):
        scene.add_texture("none.png")


def test_colours_and_materials_of_triangles_are_seen():
    scene = lit(kind="unlit")
    scene.add_material(kind="unlit", albedo=(0.5, 0.5, 0.5))
    scene.add_mesh(*QUAD, colors=[[1, 0.5, 0.25]] * 4, material=[0, 1], tangents=[[1, 0, 0, 1]] * 4)
    image = seen(scene)
    assert np.allclose(image[3, 2], (1, 0.5, 0.25)) and np.allclose(image[0, 1], (0.5, 0.25, 0.125))
    mesh = scene.meshes[0]
    assert mesh["colors"].shape == mesh["tangents"].shape == (4, 4) and (mesh["colors"][:, 3] == 1).all()
    assert (mesh["materials"] == [0, 1]).all() and mesh["mask"] == 2**32 - 1
    refused("material", lambda: scene.add_mesh(*QUAD, material=[0, 1, 2]), r"\(2,\)")
    refused("colors", lambda: scene.add_mesh(*QUAD, colors=[[1, 1]] * 4))
    refused("tangents", lambda: scene.add_mesh(*QUAD, tangents=[[1, 0, 0, 1]]), "1 rows")


def test_environments_are_seen_around(tmp_path):
    scene = claray.Scene()
    panorama = np.zeros((8, 16, 3), np.float32)
    panorama[:, :8], panorama[:, 8:] = (1, 0, 0), (0, 0, 1)  # its middle is towards -z
    scene.environment = panorama
    scene.camera = claray.Camera(position=(0, 0, 0), target=(1, 0, 0), vertical_fov=20)
    assert np.allclose(seen(scene), (0, 0, 1))
    scene.environment = claray.Environment(panorama, strength=3, rotation=np.pi)
    assert np.allclose(seen(scene), (3, 0, 0)) and scene.environment.strength == 3
    faces = [np.full((16, 16, 3), k, np.float32) for k in range(6)]
    scene.environment = claray.Environment(faces)
    assert np.allclose(seen(scene), 0) and len(scene.environment.images) == 6
    scene.camera.target = 0, 0, -1
    assert np.allclose(seen(scene), 5)
    claray.Image.save(panorama.view(claray.Image), tmp_path / "sky.hdr")
    scene.environment = claray.Environment.load(tmp_path / "sky.hdr", strength=2)
    scene.camera.target = 1, 0, 0
    assert np.allclose(seen(scene), (0, 0, 2), atol=0.02)
    scene.environment = None
    assert scene.environment is None and (seen(scene) == 0).all()
    refused("environment", lambda: setattr(scene, "environment", [1, 2]))
    refused("images", lambda: claray.Environment([np.zeros((2, 2, 7), np.float32)] * 6))
    refused("strength", lambda: claray.Environment(panorama, "strong"))


def moved(x, y=0.0):
    matrix = np.eye(4)
    matrix[:2, 3] = x, y
    return matrix


def test_instances_place_and_move_meshes():
    scene = lit(kind="unlit")
    mesh = scene.add_mesh(np.array(QUAD[0]) * 0.25, QUAD[1])
    assert scene.add_instance(mesh, moved(-0.5), name="left") == 0
    assert scene.add_instance(mesh, moved(0.5), moved(0.5, 0.5)) == 1
    placed = scene.instances
    assert placed["names"] == ("left", "") and (placed["ends"][1] == moved(0.5, 0.5)[:3]).all() and (placed["ends"][0] == moved(-0.5)[:3]).all()
    still = claray.render(scene, width=16, height=16, spp=256)[..., 0]
    scene.sky = 0, 0, 0
    image = claray.render(scene, width=16, height=16, spp=256)[..., 0]
    assert still.min() == 1 and image[8, 4] == 1  # unlit surfaces show their colour without any light
    assert 0.1 < image[4, 12] < 0.9  # where it is for a part of the time
    scene.set_instances([mesh], [moved(0)])
    assert scene.instances["ends"] is None and len(scene.instances["meshes"]) == 1
    scene.set_instances([], np.empty((0, 3, 4)))
    assert len(scene.instances["meshes"]) == 1  # every mesh once
    refused("mesh", lambda: scene.add_instance(3), "1 meshes")
    refused("transform", lambda: scene.add_instance(mesh, np.eye(3)), "4, 4")
    refused("ends", lambda: scene.set_instances([0], [np.eye(4)], [np.eye(4)] * 2))
    refused("meshes", lambda: scene.set_instances([4], [np.eye(4)]), "index 4")


def test_renderers_follow_instances_that_come_and_go():
    scene = lit(kind="unlit")
    mesh = scene.add_mesh(np.array(QUAD[0]) * 0.25, QUAD[1])
    scene.sky = 0, 0, 0
    scene.set_instances([mesh], [moved(-0.5)])
    renderer = claray.Renderer(scene, width=8, height=8, spp=1)
    for places in ([0.5], [-0.5, 0.5], [0.0], [-0.5, 0, 0.5]):
        scene.set_instances([mesh] * len(places), [moved(x) for x in places])
        renderer.update(scene, instances=True)
        image = renderer.image()
        assert (image == claray.render(scene, width=8, height=8, spp=1)).all()
        assert [x in places for x in (-0.5, 0.5)] == [bool(image[4, 2, 0]), bool(image[4, 6, 0])]
    scene.set_instances([], np.empty((0, 3, 4)))
    scene.move_vertices(mesh, QUAD[0])
    refused("normals", lambda: scene.move_vertices(mesh, QUAD[0], QUAD[0]))
    refused("vertices", lambda: scene.move_vertices(mesh, QUAD[0][1:]))
    renderer.update(scene, everything=True)
    assert (renderer.image() == 1).all()
    scene.move_vertices(mesh, np.array(QUAD[0]) + (9, 0, 0))
    renderer.update(scene, vertices=True)
    assert (renderer.image() == 0).all()


def test_cameras_have_all_projections_and_move():
    scene = lit(kind="unlit")
    scene.add_mesh(*QUAD)
    scene.sky = 0, 0, 0
    scene.camera = claray.Camera(position=(0, 0, 2), target=(0, 0, 0), projection="panorama")
    assert 0 < seen(scene, 16).mean() < 0.5
    scene.camera.orthographic_height = 8
    assert scene.camera.projection == "orthographic" and abs(seen(scene, 16).mean() - 1 / 16) < 1e-6
    scene.camera = claray.Camera(position=(0, 0, 5), target=(0, 0, 0), position_end=(9, 0, 5), target_end=(9, 0, 0), orthographic_height=2)
    blurred = claray.render(scene, width=4, height=4, spp=64)
    assert 0.05 < blurred.mean() < 0.5 and scene.camera.position_end == (9, 0, 5)
    scene.camera.position_end = scene.camera.target_end = None
    assert (seen(scene) == 1).all()
    around = scene.camera.orbited(90)
    assert np.allclose(around.position, (5, 0, 0), atol=1e-5) and scene.camera.position == (0, 0, 5)
    assert scene.automatic_camera(vertical_fov=30).vertical_fov == 30
    refused("position_end", lambda: setattr(scene.camera, "position_end", "there"))


def test_cameras_have_lenses():
    scene = lit(kind="unlit")
    scene.add_mesh(*QUAD)
    scene.sky = 0, 0, 0
    scene.camera = claray.Camera(position=(0, 0, 2), target=(0, 0, 0), projection="fisheye", vertical_fov=180)
    assert 0 < seen(scene, 16).mean() < 1
    scene.camera = claray.Camera(position=(0, 0, 9), target=(0, 0, -9), stereo="side-by-side", eye_distance=1)
    assert scene.camera.stereo == "side-by-side" and scene.camera.eye_distance == 1
    left, right = np.split(claray.render(scene, width=32, height=16, spp=4), 2, axis=1)
    assert (left != right).any() and abs(left.mean() - right.mean()) < 0.05
    scene.camera = claray.Camera(position=(0, 0, 2), target=(0, 0, 0), shift=(0.25, 0), tilt=(0, 0))
    assert scene.camera.shift == (0.25, 0)
    refused("stereo", lambda: setattr(scene.camera, "stereo", "three"), "top-bottom")
    scene.camera = claray.Camera(position=(0, 0, 2), target=(0, 0, 0), projection="cube", shift=(0.25, 0))
    refused("camera", lambda: seen(scene, 4), "shift")


def test_files_are_loaded_by_options(tmp_path):
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nf 1 2 3\n")
    with pytest.warns(UserWarning, match="left out"):
        assert claray.load(tmp_path / "line.obj", stroke_radius=0.0).primitive_count == 0
    with pytest.warns(UserWarning, match="radius 0.1"):
        assert claray.load(tmp_path / "line.obj", stroke_radius=0.1, images=False).primitive_count > 0
    assert claray.animation_seconds("cornell") is None
    refused("stroke_radius", lambda: claray.load(tmp_path / "line.obj", stroke_radius="thin"))
    refused("load", lambda: claray.load(tmp_path / "line.obj", stroke=1), "stroke")
    scene = claray.load("cornell")
    scene.set_culling("back")
    assert scene.materials[0].cull_back
    scene.validate()
    before = np.array(scene.meshes[0]["triangles"])
    scene.flip_fronts()
    assert (before != scene.meshes[0]["triangles"]).any()
    refused("culling", lambda: scene.set_culling("front"), "back")


def test_scenes_are_pickled():
    for name in ("effects", "cornell", "effect:instances", "effect:moving-instances", "curves:8"):
        scene = claray.load(name) if name != "effect:moving-instances" else moving()
        scene.fog = 0.125, (1, 0.5, 0.25), 2
        scene.name = "mine"
        twin = pickle.loads(pickle.dumps(scene))
        assert twin.name == "mine" and twin.fog == scene.fog and twin.effects() == scene.effects()
        size = {"width": 16, "height": 12, "spp": 2}
        assert (claray.render(twin, **size) == claray.render(scene, **size)).all(), name


def moving():
    scene = lit()
    scene.add_instance(scene.add_mesh(*QUAD, normals=[[0, 0, 1]] * 4, name="quad", mask=3), moved(0), moved(1))
    scene.environment = claray.Environment(np.ones((4, 8, 3), np.float32), 0.5, 1)
    return scene


def test_own_bsdfs_are_used():
    """That of examples/09_own_bsdf, which reads a parameter: the lobe's asymmetry."""
    source = (Path(__file__).parents[3] / "examples/09_own_bsdf/dust.clh").read_text(encoding="utf-8")
    number = claray.add_bsdf("dust", source, parameters=1)
    scene = lit(kind="custom", custom=number, parameters=[-0.3])
    assert scene.materials[0].kind == "custom" and np.allclose(scene.materials[0].parameters, [-0.3])
    scene.add_mesh(*QUAD)
    scene.sky = 0, 0, 0
    scene.add_light(kind="directional", direction=(0, 0, -1), intensity=(1, 1, 1))
    back = seen(scene)
    scene.materials[0].parameters = [0.3]
    forward = seen(scene)
    assert back.min() > 1.5 * forward.max() > 0
    refused("name", lambda: claray.add_bsdf("", source))
    refused("parameters", lambda: claray.add_bsdf("other", source, -1))
    with pytest.raises(claray.UsageError, match="dust"):
        claray.add_bsdf("dust", source)
