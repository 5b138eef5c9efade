"""The programs of examples/python, with small settings: each prints its figures and saves a picture that is not of one colour."""

import pathlib
import runpy
import sys

import numpy as np
import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "examples" / "python"
SMALL = {
    "lidar": (["--scene", "terrain:2000", "--steps", "64", "--points", "points.ply"], "of 4096 pulses return", (256, 64)),
    "visibility": (["--scene", "terrain:2000", "--side", "20"], "of the relief sees", (20, 20)),
    "sky_view_factor": (["--scene", "terrain:2000", "--side", "20"], "sky view factor: least 0", (20, 20)),
    "distances": (["--side", "40"], "of the plane is inside; the deepest place is 0.2", (40, 40)),
    "render": (["--spp", "1", "--width", "24"], "'spp': 1", (16, 24)),
    "xray": (["--scene", "ball:500", "--side", "24"], "the longest way inside is 0.8", (24, 24)),
    "instances": (["--trees", "40", "--side", "32"], "40 trees, 80,000 triangles", (32, 32)),
    "far_map": (["--side", "20"], "with an origin: the median error is 0.0", (20, 40)),
    "molecule": (["--spp", "1", "--width", "24"], "178 primitives", (24, 24)),
    "textures": (["--spp", "1", "--width", "24"], "3 textures; the scene uses principled", (16, 24)),
    "environment": (["--spp", "1", "--width", "24"], "1 samples per pixel", (16, 24)),
    "motion": (["--spp", "1", "--width", "48"], "6 of 13 instances move", (24, 48)),
    "animation": (["--spp", "1", "--width", "16"], "at 2.6 s: 4 balls", (24, 48)),
    "layers": (["--scene", "cornell", "--spp", "2", "--width", "16", "--exr", "all.exr"], "of the pixels see a surface", (24, 48)),
    "light_map": (["--spp", "1", "--width", "24", "--texels", "8"], "irradiance of the floor: 0.", (16, 24)),
    "town_lidar": (["--blocks", "1", "--channels", "16", "--columns", "180", "--scans", "1"], "180 cars and people", (676, 600)),
    "awaited": (["--noise", "1", "--width", "16"], "the loop ticked", (16, 16)),
}


@pytest.mark.parametrize("name", SMALL)
def test_runs(name, tmp_path, monkeypatch, capsys):
    image = pytest.importorskip("PIL.Image")
    arguments, printed, shape = SMALL[name]
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(FOLDER))  # as for a script
    monkeypatch.setattr(sys, "argv", [name, *arguments, "-o", "picture.png"])
    runpy.run_path(str(FOLDER / f"{name}.py"))
    assert printed in capsys.readouterr().out
    pixels = np.asarray(image.open("picture.png"))
    assert pixels.shape == (*shape, 3) and pixels.std() > 5
    if name == "lidar":
        lines = open("points.ply").read().splitlines()
        assert lines[2] == f"element vertex {len(lines) - 7}" and len(lines) > 500


def test_all_are_tried():
    assert {path.stem for path in FOLDER.glob("*.py")} == set(SMALL)
