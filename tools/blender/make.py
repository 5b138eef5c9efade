# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on for Blender as an extension, with wheels of claray (./dev wheel python3.11 builds one for Blender 4.5 and 5.0):

    python3 tools/blender/make.py [--out FOLDER] WHEEL...

Writes FOLDER/claray-VERSION.zip [out]. In Blender: Edit > Preferences > Get Extensions > Install from Disk.
"""

import argparse
import pathlib
import re
import sys
import zipfile

ADDON = pathlib.Path(__file__).resolve().parent / "claray"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheels", nargs="+", type=pathlib.Path, metavar="WHEEL")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out"))
    given = parser.parse_args()
    for wheel in given.wheels:
        if not wheel.is_file() or not re.fullmatch(r"claray-[^/]*\.whl", wheel.name):
            sys.exit(f"WHEEL: '{wheel}' is no wheel of claray; ./dev wheel builds one")
    manifest = (ADDON / "blender_manifest.toml").read_text()
    version = re.search(r'^version = "(.*)"$', manifest, re.MULTILINE)[1]
    listed = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in given.wheels)
    before, table = manifest.split("\n[permissions]", 1)
    given.out.mkdir(parents=True, exist_ok=True)
    packed = given.out / f"claray-{version}.zip"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", f"{before}wheels = [\n{listed}]\n\n[permissions]{table}")
        for file in sorted(ADDON.iterdir()):
            if file.suffix == ".py" or file.name == "LICENSE":
                archive.write(file, file.name)
        for wheel in given.wheels:
            archive.write(wheel, f"wheels/{wheel.name}")
    print(packed)


main()
