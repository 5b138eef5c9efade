"""Installs wheels in bare systems, where nothing of claray's is, and finds a hit there.

    python3 python/wheel/check.py [--can] [--systems FOLDER] [--release NAME]... [WHEEL...]

WHEEL: files of make.py [out/wheels]. NAME: a release of Debian whose Python one of them is for [bookworm, with Python 3.11; if there is
only a wheel for 3.12 and later, trixie]. Needs root, the package mmdebstrap, and PyPI. Each system is a folder in FOLDER
[build/bare_systems/of_wheels], which is kept. The exit code is 77 if this system cannot make another.
"""

import argparse
import json
import pathlib
import re
import shutil
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/install"))
from bare_system import BareSystem, require_tools  # noqa: E402

OF_THE_SYSTEM = re.compile(r"/(libc|libm|libdl|librt|libpthread|libstdc\+\+|libgcc_s|ld-linux[^/]*)[-.]|^/usr/lib/(python3|locale)"
                           r"|/lib(expat|z|zstd|ssl|crypto|ffi|bz2|lzma|uuid|python3[.\d]*)[-.]")  # the last ones are Python's own
MOST_SECONDS, MOST_IMPORT_SECONDS = 60, 0.05


class System(BareSystem):
    def __init__(self, folder, release, wheels):
        super().__init__(folder, release)
        self.put("wheels", (*wheels, pathlib.Path(__file__).with_name("first_hit.py")))
        shutil.rmtree(self.folder / "env", ignore_errors=True)
        self.run("python3 -m venv /env")

    def install(self, what):
        self.run(f"/env/bin/pip install -q --find-links /wheels {what}")

    def first_hit(self):
        return json.loads(self.run("/env/bin/python /wheels/first_hit.py 2>/dev/null").splitlines()[-1])


def check(systems, release, wheels):
    """Returns what is wrong."""
    wrong = []
    system = System(systems, release, wheels)
    begin = time.perf_counter()
    system.install("claray")
    alone = min((system.first_hit() for _ in range(3)), key=lambda found: found["import_seconds"])  # others use the machine, too
    if not all(word in alone.get("error", "") for word in ("apt-get install", "pip install intel-opencl-rt intel-cmplr-lib-rt")):
        wrong.append(f"without a driver: {alone}")
    elsewhere = [path for path in alone["libraries"] if not path.startswith("/env/") and not OF_THE_SYSTEM.search(path)]
    if elsewhere:
        wrong.append(f"libraries of the system: {elsewhere}")
    if alone["import_seconds"] > MOST_IMPORT_SECONDS:
        wrong.append(f"import claray takes {alone['import_seconds']:.3f} s more than import numpy")
    without = time.perf_counter() - begin
    system.install("'claray[cpu]'")
    begin = time.perf_counter()
    hit = system.first_hit()
    seconds = without + time.perf_counter() - begin
    if hit.get("t") != 1 or not hit.get("mean", 0) > 0:
        wrong.append(f"with a driver of PyPI: {hit}")
    if seconds > MOST_SECONDS:
        wrong.append(f"{seconds:.0f} s to the first hit, without the download of a driver")
    told = system.run("cd /tmp && /env/bin/claray render cornell -o cornell.png --size 32x32 --spp 1 && /env/bin/claray view cornell --help")
    if "cornell.png: 32x32" not in told or "--port" not in told:
        wrong.append(f"the program: {told}")
    print(f"{release}, Python {alone['python']}: import {alone['import_seconds']:.3f} s; {hit.get('device', 'no device')}; first hit "
          f"{seconds:.1f} s after the begin of pip install, without the download of the driver" + "".join("\n  WRONG: " + each for each in wrong))
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheels", nargs="*", type=pathlib.Path)
    parser.add_argument("--release", action="append")
    parser.add_argument("--systems", type=pathlib.Path, default=ROOT / "build/bare_systems/of_wheels")
    parser.add_argument("--can", action="store_true", help="tell only by the exit code whether this system can make another")
    options = parser.parse_args()
    require_tools()
    if options.can:
        return
    wheels = options.wheels or sorted((ROOT / "out/wheels").glob("*.whl"))
    if not wheels:
        parser.error("there is no wheel in out/wheels: python3 python/wheel/make.py makes one")
    usual = ["bookworm" if any("cp311" in path.name for path in wheels) else "trixie"]
    sys.exit(any([check(options.systems, release, wheels) for release in options.release or usual]))


if __name__ == "__main__":
    main()
