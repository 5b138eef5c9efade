# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on for Blender as an extension, with wheels of claray for Linux (./dev wheel python3.11 builds one for Blender 4.5 and 5.0):

    python3 tools/blender/make.py [--out FOLDER] WHEEL...

Writes FOLDER/claray-VERSION.zip [out]. In Blender: Edit > Preferences > Get Extensions > Install from Disk.
"""

import argparse
import pathlib
import re
import sys
import zipfile

PLATFORMS = {"x86_64": "linux-x64", "aarch64": "linux-arm64"}  # Blender's names
ADDON = pathlib.Path(__file__).resolve().parent / "claray"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheels", nargs="+", type=pathlib.Path, metavar="WHEEL")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"))
    given = parser.parse_args()
    platforms = set()
    for wheel in given.wheels:
        found = re.fullmatch(r"claray-[^/]*linux[^/]*?_(x86_64|aarch64)\.whl", wheel.name)
        if not wheel.is_file() or not found:
            sys.exit(f"WHEEL: '{wheel}' is no wheel of claray for Linux; ./dev wheel builds one")
        platforms.add(f'"{PLATFORMS[found[1]]}"')
    manifest = (ADDON / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"$', manifest, re.MULTILINE)[1]
    listed = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in given.wheels)
    before, table = manifest.split("\n[permissions]", 1)
    given.out.mkdir(parents=True, exist_ok=True)
    packed = given.out / f"claray-{version}.zip"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", f"{before}platforms = [{', '.join(sorted(platforms))}]\nwheels = [\n{listed}]\n\n[permissions]{table}")
        for file in sorted(ADDON.iterdir()):
            if file.suffix == ".py" or file.name == "LICENSE":
                archive.write(file, file.name)
        for wheel in given.wheels:
            archive.write(wheel, f"wheels/{wheel.name}")
    print(packed)


main()
