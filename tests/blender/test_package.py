"""The extension's package: its manifest, its files, the wheels that it lists, and how Blender installs it."""

import os
import pathlib
import re
import subprocess
import sys
import tomllib
import zipfile

import bpy
import claray
import pytest
import support

ROOT = pathlib.Path(__file__).resolve().parents[2]
MAKE = ROOT / "tools/blender/make.py"
TAG = "cp311-cp311" if sys.version_info[:2] == (3, 11) else "cp312-abi3"  # as python/wheel/make.py names wheels
MACHINE = os.uname().machine
# In a Blender that has no add-on yet: installs the package, enables it, renders by it, and removes it.
INSTALL = """
import pathlib, sys
import bpy
package, folder = sys.argv[1:]
assert not hasattr(bpy.types.Scene, "claray")
assert bpy.ops.extensions.package_install_files(filepath=package, repo="user_default", enable_on_install=True) == {"FINISHED"}
assert "bl_ext.user_default.claray" in bpy.context.preferences.addons
scene = bpy.context.scene
scene.render.engine, scene.claray.samples, scene.claray.device = "CLARAY", 4, "CPU"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
scene.render.image_settings.file_format, scene.render.filepath = "OPEN_EXR", folder + "/picture.exr"
bpy.ops.render.render(write_still=True)
pixels = bpy.data.images.load(scene.render.filepath).pixels[:]
print("mean", sum(pixels) / len(pixels))
print("claray", pathlib.Path(sys.modules["claray"].__file__).parent)
number = [repo.module for repo in bpy.context.preferences.extensions.repos].index("user_default")
assert bpy.ops.extensions.package_uninstall(repo_index=number, pkg_id="claray") == {"FINISHED"}
assert not hasattr(bpy.types.Scene, "claray")
assert not list(pathlib.Path(bpy.utils.user_resource("EXTENSIONS"), "user_default").glob("claray"))
"""


def make(*arguments):
    return subprocess.run([sys.executable, MAKE, *arguments], check=True, text=True, stdout=subprocess.PIPE).stdout.strip()


def wheel_of_this_build(folder):
    """A wheel of the package as it is built, which needs libraries of this system."""
    package = pathlib.Path(claray.__file__).parent
    wheel = folder / f"claray-{claray.__version__}-{TAG}-linux_{MACHINE}.whl"
    information = f"claray-{claray.__version__}.dist-info"
    with zipfile.ZipFile(wheel, "w") as archive:
        for file in package.rglob("*"):
            if file.is_file() and "__pycache__" not in file.parts:
                archive.write(file, pathlib.Path("claray") / file.relative_to(package))
        archive.writestr(f"{information}/METADATA", f"Metadata-Version: 2.1\nName: claray\nVersion: {claray.__version__}\n")
        archive.writestr(f"{information}/WHEEL", f"Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: {TAG}-linux_{MACHINE}\n")
        archive.writestr(f"{information}/RECORD", "")
    return wheel


def wheel_to_give_away(folder):
    """The one that CTest's `wheel` made, which needs no library of the system but a driver."""
    found = sorted(ROOT.glob(f"build/wheel/test/claray-*-{TAG}-*_{MACHINE}.whl"))
    if not found:
        pytest.skip(f"build/wheel/test has no wheel for {TAG}: ctest -R wheel makes it")
    return found[0]


@pytest.mark.parametrize("wheel_in", [wheel_of_this_build, wheel_to_give_away])
def test_blender_installs_the_package_and_renders_by_it(wheel_in, tmp_path):
    package = make("--out", tmp_path, wheel_in(tmp_path))
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["BLENDER_USER_RESOURCES"] = str(tmp_path / "user")
    (tmp_path / "user").mkdir()
    done = subprocess.run([sys.executable, "-c", INSTALL, package, tmp_path], env=environment, cwd=tmp_path, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr
    told = dict(line.split(" ", 1) for line in done.stdout.splitlines() if line.startswith(("mean ", "claray ")))
    expected = support.picture(support.default_scene(32, 24), "CLARAY", 4).mean()
    assert float(told["mean"]) == pytest.approx(expected, rel=1e-3)
    assert pathlib.Path(told["claray"]).is_relative_to(tmp_path / "user/extensions/.local")


def test_blender_finds_no_fault_in_the_manifest(tmp_path):
    tool = next(pathlib.Path(bpy.utils.resource_path("LOCAL")).glob("scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    package = make("--out", tmp_path, false_wheel(tmp_path, f"{TAG}-manylinux_2_35_x86_64"))
    done = subprocess.run([sys.executable, tool, "validate", package], text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr


def false_wheel(folder, tags):
    wheel = folder / f"claray-0.1.0-{tags}.whl"
    wheel.write_bytes(b"wheel")
    return wheel


@pytest.mark.parametrize("tag, first, end", [("cp311-cp311", "4.5.0", "5.1.0"), ("cp312-abi3", "5.1.0", None)])
def test_package_lists_its_wheels_and_the_blenders_that_take_them(tag, first, end, tmp_path):
    wheels = [false_wheel(tmp_path, f"{tag}-{platform}") for platform in ("manylinux_2_35_x86_64", "linux_aarch64")]
    with zipfile.ZipFile(make("--out", tmp_path, *wheels)) as archive:
        names = set(archive.namelist())
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert {"__init__.py", "engine.py", "LICENSE", f"wheels/{wheels[0].name}"} <= names
    assert manifest["wheels"] == [f"./wheels/{wheel.name}" for wheel in wheels] and manifest["platforms"] == ["linux-arm64", "linux-x64"]
    assert manifest["blender_version_min"] == first and manifest.get("blender_version_max") == end
    assert manifest["id"] == "claray" and "files" in manifest["permissions"] and manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert manifest["version"] == re.search(r"^project\(claray VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]


@pytest.mark.parametrize("tags", [["x"], ["cp311-cp311-win_amd64"], ["cp310-cp310-linux_x86_64"],
                                  ["cp311-cp311-linux_x86_64", "cp312-abi3-linux_x86_64"]])
def test_package_refuses_other_wheels(tags, tmp_path):
    done = subprocess.run([sys.executable, MAKE, "--out", tmp_path, *(false_wheel(tmp_path, tag) for tag in tags)], text=True, capture_output=True)
    assert done.returncode == 1 and done.stderr.startswith("WHEEL: ") and done.stderr.count("\n") == 1 and not list(tmp_path.glob("*.zip"))


def test_every_file_of_the_addon_names_its_licence():
    files = [*ROOT.glob("tools/blender/**/*.py")]
    assert len(files) > 8
    for file in files:
        assert file.read_text().startswith("# SPDX-License-Identifier: GPL-3.0-or-later\n"), file
    assert "GNU GENERAL PUBLIC LICENSE" in (ROOT / "tools/blender/claray/LICENSE").read_text()
