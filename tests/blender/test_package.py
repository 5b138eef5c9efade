"""The extension's package: its manifest, its files and the wheels that it lists."""

import pathlib
import re
import subprocess
import sys
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MAKE = ROOT / "tools/blender/make.py"


def test_package_lists_its_wheels(tmp_path):
    wheel = tmp_path / "claray-0.1.0-cp311-cp311-linux_x86_64.whl"
    wheel.write_bytes(b"wheel")
    made = subprocess.run([sys.executable, MAKE, "--out", tmp_path, wheel], check=True, text=True, stdout=subprocess.PIPE).stdout.strip()
    with zipfile.ZipFile(made) as archive:
        names = set(archive.namelist())
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert {"__init__.py", "engine.py", "LICENSE", f"wheels/{wheel.name}"} <= names
    assert manifest["wheels"] == [f"./wheels/{wheel.name}"] and manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert manifest["id"] == "claray" and "files" in manifest["permissions"]
    assert manifest["version"] == re.search(r"^project\(claray VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]


def test_package_refuses_other_files(tmp_path):
    done = subprocess.run([sys.executable, MAKE, "--out", tmp_path, tmp_path / "x.whl"], text=True, stderr=subprocess.PIPE)
    assert done.returncode == 1 and done.stderr.startswith("WHEEL: '") and done.stderr.count("\n") == 1


def test_every_file_of_the_addon_names_its_licence():
    files = [*ROOT.glob("tools/blender/**/*.py")]
    assert len(files) > 8
    for file in files:
        assert file.read_text().startswith("# SPDX-License-Identifier: GPL-3.0-or-later\n"), file
    assert "GNU GENERAL PUBLIC LICENSE" in (ROOT / "tools/blender/claray/LICENSE").read_text()
