"""Seconds from the start of a process to its first answer, with empty and with full caches.

    python3 bench/league/cold.py [--only NAME...] [--rounds N] [--csv FILE]

A new process imports the library, builds a mesh of 101,250 triangles and traces 100,000 rays (first_rays.py); claray also renders
its first picture. With empty caches each process has new folders for what it compiles; with full ones it has those of two processes
before it, the second of which waits for all kernels.
"""

import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
import time

FOLDER = os.path.dirname(os.path.abspath(__file__))
CLARAY = os.path.join(FOLDER, "../../build/bin/claray")
COLUMNS = ("task", "program", "caches", "seconds", "note", "command")
TRACERS = ("claray", "embreex", "mitsuba", "open3d", "warp")


def command_of(name, folder):
    if name == "claray render":
        picture = os.path.join(folder, "cornell.pfm")
        return [CLARAY, "render", "cornell", "--size", "256x256", "--spp", "1", "-q", "-o", picture]
    return [sys.executable, os.path.join(FOLDER, "first_rays.py"), name]


def seconds(command, folder, limit):
    """The clock's time of a whole process whose caches are in the folder, or a note. Mitsuba's cache is in HOME/.drjit."""
    caches = {"CLARAY_CACHE_DIR": folder + "/claray", "POCL_CACHE_DIR": folder + "/pocl", "HOME": folder, "WARP_CACHE_PATH": folder + "/warp",
              "XDG_CACHE_HOME": folder + "/other"}
    begin = time.perf_counter()
    try:
        told = subprocess.run(command, env=dict(os.environ, **caches), capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None, "hangs"
    except OSError as error:
        return None, "left out: %s" % error
    if told.returncode == 2:
        return None, "left out: " + told.stderr.strip().splitlines()[-1]
    return time.perf_counter() - begin, "aborts" if told.returncode else ""


def measure(name, options):
    """Rows of a program: empty caches, and full ones."""
    times, note = {"empty": [], "full": []}, ""
    for _ in range(options.rounds):
        with tempfile.TemporaryDirectory() as folder:
            command = command_of(name, folder)
            filling = command + (["--wait-for-kernels"] if name == "claray render" else [])
            for words, found in ((command, times["empty"]), (filling, []), (command, times["full"])):
                if not note:
                    took, note = seconds(words, folder, options.limit)
                    found.append(took)
    task = "first picture" if name == "claray render" else "first rays"
    for caches, found in times.items():
        yield [task, name, caches, "" if note else "%.3f" % statistics.median(found), note, "python3 bench/league/cold.py --only '%s'" % name]


def main():
    names = (*TRACERS, "claray render")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME", help="[%s]" % ", ".join(names))
    parser.add_argument("--rounds", type=int, default=3, help="[3]")
    parser.add_argument("--limit", type=float, default=120, help="seconds for one process [120]")
    parser.add_argument("--csv")
    options = parser.parse_args()
    rows = []
    for name in options.only:
        for row in measure(name, options):
            rows.append(row)
            print("%-14s %-14s %-6s %8s s %s" % tuple(row[:5]), flush=True)
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file).writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
