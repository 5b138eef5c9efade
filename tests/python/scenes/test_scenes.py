"""Scenes, images, accuracy and verification."""

import io
import math

import numpy as np
import pytest

import claray


def furnace():
    """A white ball of Lambert's kind under a sky of radiance 1: every pixel of it is 1."""
    scene = claray.load("ball:500")
    scene.materials = [claray.Material(albedo=(1, 1, 1)) for _ in scene.materials]
    scene.lights = []
    scene.sky = (1, 1, 1), (1, 1, 1)
    return scene


def test_images_of_a_furnace_are_white():
    image = claray.render(furnace(), width=24, height=16, spp=16)
    assert image.shape == (16, 24, 3) and image.dtype == np.float32
    assert abs(float(image.mean()) - 1) < 0.02


def test_fog_lies_before_the_sky():
    scene = furnace()
    scene.fog = 0.5, (3, 2, 1), 2
    assert scene.fog == (0.5, (3, 2, 1), 2)
    scene.camera = claray.Camera(position=(0, 100, 0), target=(0, 200, 0), up=(0, 0, 1))
    left = np.exp(-0.5 * 2)
    image = claray.render(scene, width=4, height=4, spp=1)
    assert np.allclose(image, left + (1 - left) * np.array([3, 2, 1]), rtol=1e-5)


def test_images_show_and_save_themselves(tmp_path):
    pillow = pytest.importorskip("PIL.Image")
    renderer = claray.Renderer(claray.load("cornell"), width=24, height=16, spp=4)
    assert renderer._repr_png_() is None  # before it has rendered
    image = renderer.image()
    shown = np.asarray(pillow.open(io.BytesIO(image._repr_png_())))
    assert (shown == image.to_bytes()).all() and shown.std() > 10
    image.save(tmp_path / "a.png")
    assert (np.asarray(pillow.open(tmp_path / "a.png")) == shown).all()
    assert isinstance(image[2:], claray.Image) and image[..., 0]._repr_png_() is None
    assert (image * 2).to_bytes().mean() > shown.mean()


def test_scenes_of_primitives_show_their_colours():
    """Convex and alone under a white sky, so that every pixel is the albedo."""
    scene = claray.Scene()
    white, grey = scene.add_material(albedo=(1, 1, 1)), scene.add_material(albedo=(0.5, 0.5, 0.5))
    scene.sky = (1, 1, 1), (1, 1, 1)
    assert scene.add_spheres([[-4, 0, 0], [-2, 0, 0]], 0.6, colors=[[0.2, 0.4, 0.6], [0.8, 0.6, 0.4]], material=[white, grey]) == 0
    assert scene.add_discs([[0, 0, 0]], [[0, 0, 1]], 0.6, 0.25, colors=(0.3, 0.2, 0.1), material=white) == 1
    scene.add_cylinders([[2, -1, 0]], [[2, 1, 0]], 0.5, colors=[[[1, 0, 0], [0, 0, 1]]], material=white)
    scene.add_curves([[[4, y, 0] for y in (-1, -0.5, 0.5, 1)]], 0.5, basis="bezier", material=grey)
    scene.add_curves([[[x, 2, 0] for x in (-3, -1, 1, 3, 5)]], 0.4, material=[white, grey])
    assert scene.primitive_count == 7 and "7 primitives" in repr(scene) and scene.bounds[1][1] >= 2.4
    scene.camera = claray.Camera(position=(0, 0, 10), target=(0, 0, 0), orthographic_height=6)
    image = claray.render(scene, width=120, height=60, spp=4)
    seen = {(-4, 0): (0.2, 0.4, 0.6), (-2, 0): (0.4, 0.3, 0.2), (0, 0): (1, 1, 1), (0, 0.4): (0.3, 0.2, 0.1), (4, 0): (0.5, 0.5, 0.5),
            (0, 2): (1, 1, 1), (2, 2): (0.5, 0.5, 0.5)}
    for (x, y), color in seen.items():
        assert np.allclose(image[int(30 - 10 * y), int(60 + 10 * x)], color, atol=1e-3), (x, y)
    begin, end = image[30 + 8, 60 + 20], image[30 - 8, 60 + 20]
    assert begin[0] > 0.85 and begin[2] < 0.15 and end[0] < 0.15 and end[2] > 0.85
    with pytest.raises(claray.UsageError, match="colors: has shape"):
        scene.add_spheres([[0, 0, 0]], 1, colors=[[1, 1, 1], [1, 1, 1]])
    with pytest.raises(claray.UsageError, match="material: has shape"):
        scene.add_spheres([[0, 0, 0]], 1, material=[0, 1])
    with pytest.raises(claray.UsageError, match="segments: holds the index 9"):
        scene.add_curves([[0, 0, 0]] * 5, 1, [9])
    assert scene.primitive_count == 7
    scene.add_spheres([[0, 0, 0]], 1, material=9)
    with pytest.raises(claray.InputError, match="primitive set 5.*material 9 of 2"):
        claray.Renderer(scene, width=4, height=4)


def test_lamps_of_primitives_are_warned_of():
    scene = claray.Scene()
    scene.add_spheres([[0, 0, 0]], 1, material=scene.add_material(emission=(1, 1, 1)), name="bulbs")
    with pytest.warns(UserWarning, match="'bulbs' emits light"):
        claray.Renderer(scene, width=4, height=4)


def test_added_light_is_told_where_it_is_seen(tmp_path, recwarn):
    (tmp_path / "dark.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    scene = claray.load(tmp_path / "dark.obj")
    assert claray.any_hit(claray.Bvh(scene), [[0.2, 0.2, 1]], (0, 0, -1)).all() and not recwarn
    chosen = scene.copy()
    chosen.sky = 1, 1, 1
    claray.Renderer(chosen, width=4, height=4)
    assert not recwarn
    with pytest.warns(UserWarning, match="no light: added a neutral studio.*Scene.sky"):
        claray.Renderer(scene, width=4, height=4)
    claray.Renderer(scene, width=4, height=4)
    assert not recwarn


def test_renders_stop_for_callbacks():
    renderer = claray.Renderer(claray.load("cornell"), width=16, height=16, spp=8)

    def fail(progress):
        raise KeyError(progress["spp"])

    with pytest.raises(KeyError):
        renderer.render(fail)
    assert renderer.render(lambda progress: False)["spp"] >= 1
    assert renderer.render()["spp"] == 8
    first = renderer.image()
    renderer.restart(1)
    assert not (renderer.image() == first).all()
    renderer.restart(0)
    assert (renderer.image() == first).all()


def test_the_memory_of_the_denoiser_is_given_back():
    renderer = claray.Renderer(claray.load("cornell"), width=32, height=32, spp=2)
    renderer.render()
    before = renderer.device_bytes
    image = renderer.image(denoise="claray")
    assert renderer.device_bytes > before
    renderer.release_denoiser()
    assert renderer.device_bytes == before
    assert (renderer.image(denoise="claray") == image).all()


def test_error_map_tells_how_far_pixels_are_from_the_truth():
    scene = claray.load("crate")
    truth = claray.Renderer(scene, width=48, height=48, spp=2048, seed=3).image()
    renderer = claray.Renderer(scene, width=48, height=48, spp=32)
    widths = renderer.error_map()
    assert widths.shape == (48, 48) and widths.dtype == np.float32
    luminance = np.array([0.2126, 0.7152, 0.0722])
    within = abs((renderer.image() - truth) @ luminance) <= widths
    assert 0.91 < within.mean() < 0.99


def test_aovs_agree_with_rays():
    scene = claray.load("cornell")
    size = 16
    aovs = claray.Renderer(scene, width=size, height=size, spp=1).aovs()
    camera = scene.camera
    eye, target = np.array(camera.position), np.array(camera.target)
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    at = (np.arange(size) + 0.5) / size * 2 - 1
    half = math.tan(math.radians(camera.vertical_fov) / 2)
    directions = forward + half * (at[None, :, None] * right - at[:, None, None] * up)
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    hits = claray.closest_hit(claray.Bvh(scene), eye, directions.reshape(-1, 3))
    assert (hits["primitive"] == aovs["primitive"].ravel()).mean() > 0.97
    np.testing.assert_allclose(np.median(hits["t"] / aovs["depth"].ravel()), 1, rtol=1e-3)
    assert aovs["normal"].shape == (size, size, 3)


def test_scenes_are_put_together():
    scene = claray.Scene()
    red = scene.add_material(albedo=(0.9, 0.1, 0.1), kind="principled", roughness=0.5)
    scene.add_material(claray.Material("mirror"))
    scene.add_light(position=(0, 0, 3), intensity=(5, 5, 5))
    scene.add_mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]], material=red, name="triangle", uvs=np.zeros((3, 2)))
    scene.camera = claray.Camera(position=(0, 0, 4), target=(0, 0, 0))
    mesh = scene.meshes[0]
    assert mesh["name"] == "triangle" and mesh["vertices"].shape == (3, 3) and not mesh["vertices"].flags.writeable
    assert scene.triangle_count == 1 and (scene.bounds == [[-1, -1, 0], [1, 1, 0]]).all()
    image = claray.render(scene, width=9, height=9, spp=4)
    assert image[4, 4, 0] > 3 * image[4, 4, 1] > 0
    copy = scene.copy()
    del scene
    assert mesh["vertices"].sum() == -1  # the views keep the scene
    assert copy.lights[0].kind == "point" and copy.materials[0].kind == "principled"


def test_accuracy_and_verify():
    seen = []
    study = claray.accuracy(claray.load("cornell"), "depth", width=16, height=16, runs=1,
                            progress=lambda done, what: seen.append(done))
    assert study.points and study._repr_svg_().startswith("<svg") and seen
    with pytest.raises(ZeroDivisionError):
        claray.accuracy(claray.load("cornell"), "depth", width=16, height=16, runs=1, progress=lambda done, what: 1 / 0)
    assert "edges" in claray.verify_cases() and "sampling" in claray.studies()
    results = claray.verify(["boxes"], report=lambda result: seen.append(result["name"]))
    assert [r["name"] for r in results] == ["boxes"] and results[0]["holds"] and seen[-1] == "boxes"
