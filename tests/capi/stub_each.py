#!/usr/bin/env python3
"""Replaces each function of claray.h by one that does nothing and returns 0, and tells those that no test misses.

Usage: stub_each.py BUILD [NAME...]: by the tests in the build folder; these, or all but releases. Takes some minutes.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
here = Path(__file__).resolve().parent
sys.path.insert(0, str(here))
from bindings import Header  # noqa: E402

# Their effect is on speed alone.
unseen = {"claray_bvh_is_replaced", "claray_renderer_load_kernels"}
groups = {"capi_test.c": ["basics"], "devices_test.c": ["devices"], "queries_test.c": ["queries"], "scenes_test.c": ["scenes"],
          "renders_test.c": ["renders", "bsdf"], "results_test.c": ["results"],
          "targets_test.c": ["targets"], "sensors_test.c": ["sensors"]}


def is_missed(name: str, build: Path, folder: Path) -> bool:
    """Whether the tests fail without the function."""
    wanted = [group for file, names in groups.items() if name + "(" in (here / file).read_text() for group in names]
    stub = folder / "stub.so"
    source = f"long {name}(void) {{ return 0; }}"
    subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", stub], input=source, text=True, check=True)
    environment = {**os.environ, "LD_PRELOAD": str(stub)}
    done = subprocess.run([build / "bin/test_capi", *wanted], env=environment, cwd=folder, capture_output=True)
    return not wanted or done.returncode != 0


def main() -> int:
    build = Path(sys.argv[1]).resolve()
    names = sys.argv[2:] or [name for name in Header().functions if not name.endswith("_release") and name not in unseen]
    tests = "".join((here / file).read_text() for file in groups)
    with tempfile.TemporaryDirectory() as folder:
        faults = [name for name in names if name + "(" not in tests or not is_missed(name, build, Path(folder))]
    print("\n".join(f"no test misses {name}" for name in faults) or f"tests miss each of {len(names)} functions")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
