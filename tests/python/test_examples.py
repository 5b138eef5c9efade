"""The programs of examples/python, with small settings: each prints its figures and saves a picture that is not of one colour."""

import pathlib
import runpy
import sys

import numpy as np
import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"
SMALL = {
    "lidar": (["--scene", "terrain:2000", "--steps", "64", "--points", "points.ply"], "of 4096 pulses return", (256, 64)),
    "visibility": (["--scene", "terrain:2000", "--side", "20"], "of the relief sees", (20, 20)),
    "sky_view_factor": (["--scene", "terrain:2000", "--side", "20"], "sky view factor: least 0", (20, 20)),
    "distances": (["--side", "40"], "of the plane is inside; the deepest place is 0.2", (40, 40)),
    "render": (["--spp", "1", "--width", "24"], "'spp': 1", (16, 24)),
}


@pytest.mark.parametrize("name", SMALL)
def test_runs(name, tmp_path, monkeypatch, capsys):
    image = pytest.importorskip("PIL.Image")
    arguments, printed, shape = SMALL[name]
    monkeypatch.chdir(tmp_path)
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
