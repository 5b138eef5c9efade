"""Compares claray with its peers: rays, hard cases, error against time, cold starts. ./dev league runs it.

    python3 bench/league/league.py [--only SECTION...] [--files FOLDER] [--out FOLDER] [--tinybvh FOLDER] [--device NAME]

Each section is a command of its own, whose CSV goes to OUT (docs/league/DEVICE-DATE), beside index.html. A section that fails is
named on the page, and the others go on. OUT appears when all is written.
"""

import argparse
import csv
import datetime
import glob
import importlib.util
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import page  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
SCENES = ("hall", "window", "glass", "studio")
PEERS = ("mitsuba", "drjit", "embreex", "open3d", "warp-lang", "bpy", "trimesh", "vtk", "cgal", "libigl", "fcpw", "point-cloud-utils", "numpy")


def sections(options):
    """Names and commands; a command gets --csv FILE."""
    files = ["--files", options.files] if options.files else []
    tinybvh = ["--tinybvh", options.tinybvh] if options.tinybvh else []
    render = ["bench/renderers/efficiency.py", "build/bin/claray", *SCENES, "--defaults", "--size", "128", "--spp", "64", "--seeds", "3"]
    return {"rays": ["bench/league/rays.py", *files, *tinybvh], "hard": ["bench/hardrays/run.py", *tinybvh], "mitsuba": [*render, "--peer", "mitsuba"],
            "cycles": [*render, "--peer", "cycles"], "cold": ["bench/league/cold.py"], **dict(options.section)}


def shown(command):
    """The command as a reader types it."""
    words = ["FOLDER" if previous in ("--files", "--tinybvh") else word for previous, word in zip(["", *command], command)]
    return "python3 " + shlex.join(words)


def newest_llvm():
    """Version and path; Mitsuba itself takes whichever it finds first, and its code breaks the compiler of LLVM 14."""
    found = [(int(number[1]), path) for path in glob.glob("/usr/lib/*/libLLVM[.-]*so*") if (number := re.search(r"libLLVM(?:\.so\.|-)(\d+)", path))]
    return max(found, default=(0, ""))


def environment():
    """Peers find claray's package, and Mitsuba the newest LLVM."""
    made = dict(os.environ, PYTHONDONTWRITEBYTECODE="1", XDG_CONFIG_HOME="/nonexistent")
    made["PYTHONPATH"] = os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), str(ROOT / "build/python")]))
    made.setdefault("CLARAY_CACHE_DIR", str(ROOT / "build/kernel_cache"))
    if newest_llvm()[0]:
        made.setdefault("DRJIT_LIBLLVM_PATH", os.path.realpath(newest_llvm()[1]))
    return made


def missing_packages():
    """Debian packages without which a peer does not start."""
    if importlib.util.find_spec("mitsuba") and "DRJIT_LIBLLVM_PATH" not in os.environ and newest_llvm()[0] < 15:
        yield "Mitsuba needs LLVM 15 or newer: install libllvm19"
    if importlib.util.find_spec("open3d") and not glob.glob("/usr/lib/*/libusb-1.0.so.0") and "LD_LIBRARY_PATH" not in os.environ:
        yield "Open3D needs libusb: install libusb-1.0-0"


def run(name, command, folder, limit):
    """A section's seconds and note."""
    begin, log = time.monotonic(), folder / (name + ".log")
    print("league: %s: %s" % (name, shown(command)), flush=True)
    with open(log, "w") as file:
        try:
            told = subprocess.run([sys.executable, *command, "--csv", str(folder / (name + ".csv"))], cwd=ROOT, env=environment(), stdout=file,
                                  stderr=subprocess.STDOUT, timeout=limit)
            note = "" if told.returncode == 0 else "fails with exit code %d: %s" % (told.returncode, last_line(log))
        except subprocess.TimeoutExpired:
            note = "takes more than %g s" % limit
    print("league: %s: %s (%.0f s)" % (name, note or "done", time.monotonic() - begin), flush=True)
    return {"name": name, "seconds": "%.0f" % (time.monotonic() - begin), "note": note, "command": shown(command)}


def last_line(log):
    return (log.read_text(errors="replace").strip().splitlines() or ["no output"])[-1][:200]


def printed(command):
    try:
        return subprocess.run(command, cwd=ROOT, env=environment(), capture_output=True, text=True).stdout
    except OSError:
        return ""


def facts(options):
    """What stands at the head of the page."""
    device, commit = printed(["build/bin/claray", "devices"]), printed(["git", "rev-parse", "--short", "HEAD"]).strip()
    yield "date", options.date
    yield "device", options.device
    yield "claray's devices", "; ".join(line.strip() for line in device.splitlines()[1:] if line.strip())
    yield "cores", str(len(os.sched_getaffinity(0)))
    yield "system", platform.platform()
    yield "claray", commit
    for peer in PEERS:
        try:
            yield peer, version(peer)
        except PackageNotFoundError:
            yield peer, "not installed"
    yield "LLVM of Mitsuba", os.path.basename(environment().get("DRJIT_LIBLLVM_PATH", "none"))
    for line in missing_packages():
        yield "missing", line


def processor():
    """As a part of a folder's name."""
    found = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M) if os.path.exists("/proc/cpuinfo") else None
    return "pocl-" + re.sub(r"[^a-z0-9]+", "-", (found[1] if found else platform.machine()).lower()).strip("-")[:40]


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def options_of_command_line():
    parser = argparse.ArgumentParser(prog="./dev league", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", metavar="SECTION", help="rays, hard, mitsuba, cycles, cold [all]")
    parser.add_argument("--files", type=os.path.abspath, help="a folder with sponza.obj, sibenik.obj, bunny.obj or igea.obj, which add scenes of rays")
    parser.add_argument("--tinybvh", type=os.path.abspath, help="a folder with tinybvh's tiny_bvh.h (version 1.6.7), which no registry has")
    parser.add_argument("--device", default=processor(), help="the device's name in OUT [%(default)s]")
    parser.add_argument("--out", type=Path, help="[docs/league/DEVICE-DATE]")
    parser.add_argument("--limit", type=float, default=1200, help="seconds for a section [1200]")
    parser.add_argument("--section", nargs="+", action="append", default=[], help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.section = [(words[0], shlex.split(words[1])) for words in options.section]
    options.date = datetime.date.today().isoformat()
    options.out = options.out or ROOT / "docs/league" / ("%s-%s" % (options.device, options.date))
    unknown = set(options.only or ()) - set(sections(options))
    if unknown:
        parser.error("unknown section %s; choose from %s" % (unknown.pop(), " ".join(sections(options))))
    return options


def main():
    options = options_of_command_line()
    for line in missing_packages():
        print("league: " + line, flush=True)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=options.out.parent, prefix=".league") as temporary:
        folder = Path(temporary) / "page"
        folder.mkdir(mode=0o755)
        ran = [run(name, command, folder, options.limit) for name, command in sections(options).items() if name in (options.only or sections(options))]
        write_csv(folder / "sections.csv", [list(ran[0]), *(list(section.values()) for section in ran)])
        write_csv(folder / "facts.csv", [("fact", "value"), *facts(options)])
        page.write(folder)
        for log in folder.glob("*.log"):
            log.unlink()
        if options.out.exists():
            shutil.rmtree(options.out)
        folder.rename(options.out)
    print("league: the page is %s" % (options.out / "index.html"))
    return int(any(section["note"] for section in ran))


if __name__ == "__main__":
    sys.exit(main())
