"""The script by which the program reads a .blend (host/io/python/blend_script.hpp): its glTF shows what the add-on shows."""

import json
import math
import pathlib
import subprocess
import sys
import warnings

import bpy
import claray
import numpy as np
import pytest
import support

HEADER = pathlib.Path(__file__).resolve().parents[2] / "host/io/python/blend_script.hpp"
SCRIPT = HEADER.read_text().split('R"py(', 1)[1].split(')py"', 1)[0]


def converted(file, folder):
    """The scene that the program reads, what glTF lacks, and how the script ended."""
    done = subprocess.run([sys.executable, "-c", SCRIPT, str(file), str(folder / "scene.glb")], capture_output=True, text=True)
    if done.returncode:
        return None, None, done
    extra = json.loads((folder / "scene.json").read_text())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = claray.load(folder / "scene.glb")
    if extra["sky"] or extra["environment"]:
        scene.environment, scene.sky = None, tuple(extra["sky"] or (0, 0, 0))
    if extra["environment"]:
        given = extra["environment"]
        scene.environment = claray.Environment(given["file"], given["strength"], given["rotation"])
    for sun in extra["suns"]:
        scene.add_light(kind="sun", direction=sun["direction"], intensity=sun["irradiance"], outer_angle=sun["angle"])
    return scene, extra, done


def save(tmp_path):
    file = tmp_path / "scene.blend"
    with support.quiet():
        bpy.ops.wm.save_as_mainfile(filepath=str(file))
    return file


def same_mean(scene, tmp_path, told=(), samples=64):
    expected = support.picture(scene, "CLARAY", samples)[..., :3].mean((0, 1))
    made, extra, done = converted(save(tmp_path), tmp_path)
    assert done.returncode == 0, done.stderr
    image = np.asarray(claray.render(made, width=scene.render.resolution_x, height=scene.render.resolution_y, spp=samples, max_depth=12))
    np.testing.assert_allclose(image.mean((0, 1)), expected, rtol=0.02)
    assert extra["warnings"] == list(told)
    return made


def test_room_with_an_area_light(tmp_path):
    scene = support.empty_scene(64, 48)
    support.interior(scene)
    same_mean(scene, tmp_path, samples=128)


def test_suns_points_and_an_image_of_the_world(tmp_path):
    scene = support.empty_scene(64, 48)
    support.add_plane(scene, support.diffuse((0.8, 0.6, 0.4)), 6)
    support.add_light(scene, "SUN", (0, 0, 5), (1, 0, 0), energy=2, angle=0.2)
    support.add_light(scene, "POINT", (1, 0, 3), energy=50, shadow_soft_size=0)
    support.set_world_image(scene)
    made = same_mean(scene, tmp_path, samples=128)
    assert sorted(light.kind for light in made.lights) == ["point", "sun"]
    assert made.environment.rotation == pytest.approx(-math.pi / 2)


def test_shaders_that_the_exporter_does_not_know(tmp_path):
    scene = support.empty_scene(64, 48)
    for i, given in enumerate((support.diffuse((0.8, 0.2, 0.1)), support.emission((0.2, 0.5, 1), 2),
                               support.material("ShaderNodeBsdfAnisotropic", "metal", Color=(0.9, 0.6, 0.2, 1), Roughness=0.5)[0])):
        support.add_plane(scene, given, 0.9, name=f"plane{i}").location.x = i - 1
    support.set_world(scene, (0.5, 0.5, 0.5))
    same_mean(scene, tmp_path)


def test_what_is_left_out_is_told(tmp_path):
    scene = support.empty_scene(16, 16)
    support.add_plane(scene, support.material("ShaderNodeBsdfSheen", "velvet")[0])
    support.add_light(scene, "POINT", energy=10, shadow_soft_size=0.2)
    support.link(scene, "smoke", bpy.data.volumes.new("smoke"))
    _, extra, _ = converted(save(tmp_path), tmp_path)
    told = "\n".join(extra["warnings"])
    for part in ("'velvet': the shader", "have no radius", "'smoke' is of the type volume"):
        assert part in told


def test_damaged_file(tmp_path):
    support.default_scene(16, 16)
    file = save(tmp_path)
    file.write_bytes(file.read_bytes()[:2000])
    _, _, done = converted(file, tmp_path)
    assert done.returncode == 1 and done.stderr.strip().splitlines()[-1].startswith("Error")
