# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on for Blender as an extension, with wheels of claray for Linux, all for the same Python:

    python3 tools/blender/make.py [--out FOLDER] WHEEL...

./dev wheel python3.11 builds a wheel for Blender 4.5 and 5.0, ./dev wheel python3.12 (or later) one for Blender 5.1 and later. Writes
FOLDER/claray-VERSION-blender4.5.zip or -blender5.1.zip [out]. In Blender: Edit > Preferences > Get Extensions > Install from Disk.
"""

import argparse
import pathlib
import re
import sys
import zipfile

# By the tag of a wheel: the first version of Blender with a Python that takes it, and the first that has a later one. Blender takes a wheel of the
# stable interface (abi3) for every Python 3, and refuses a package if any of its wheels is for another Python.
VERSIONS = {"cp311-cp311": ("4.5.0", "5.1.0"), "cp312-abi3": ("5.1.0", None)}
PLATFORMS = {"x86_64": "linux-x64", "aarch64": "linux-arm64"}  # Blender's names
ADDON = pathlib.Path(__file__).resolve().parent / "claray"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheels", nargs="+", type=pathlib.Path, metavar="WHEEL")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"))
    given = parser.parse_args()
    tags, platforms = set(), set()
    for wheel in given.wheels:
        found = re.fullmatch(r"claray-[^-/]*-(cp\d+-\w+)-[^-/]*linux[^-/]*?_(x86_64|aarch64)\.whl", wheel.name)
        if not wheel.is_file() or not found or found[1] not in VERSIONS:
            sys.exit(f"WHEEL: '{wheel}' is no wheel of claray for Linux and {' or '.join(VERSIONS)}; ./dev wheel builds one")
        tags.add(found[1])
        platforms.add(f'"{PLATFORMS[found[2]]}"')
    if len(tags) > 1:
        sys.exit(f"WHEEL: the wheels are for {' and '.join(sorted(tags))}, which no Blender takes together; make a package of each")
    first, end = VERSIONS[tags.pop()]
    manifest = (ADDON / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"$', manifest, re.MULTILINE)[1]
    before, table = manifest.split("\n[permissions]", 1)
    bounds = f'blender_version_min = "{first}"\n' + (f'blender_version_max = "{end}"\n' if end else "")
    before = re.sub(r"^blender_version_min = .*\n", bounds, before, flags=re.MULTILINE)
    listed = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in given.wheels)
    given.out.mkdir(parents=True, exist_ok=True)
    packed = given.out / f"claray-{version}-blender{first[:3]}.zip"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", f"{before}platforms = [{', '.join(sorted(platforms))}]\nwheels = [\n{listed}]\n\n[permissions]{table}")
        for file in sorted(ADDON.iterdir()):
            if file.suffix == ".py" or file.name == "LICENSE":
                archive.write(file, file.name)
        for wheel in given.wheels:
            archive.write(wheel, f"wheels/{wheel.name}")
    print(packed)


main()
