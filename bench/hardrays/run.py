"""Counts wrong answers of ray tracers to hard rays. Prints tables: cases by tracers.

    python3 bench/hardrays/run.py [--only CASE...] [--tracer NAME...] [--json FILE] [--csv FILE]

Each tracer runs in a process of its own. One that is not installed is named and left out. One that aborts or takes longer
than --limit seconds for a case has "aborts" or "hangs" there, and goes on with the next case in a new process. One that
raises an error has "refuses"; one that cannot ask the question has "-".
"""

import argparse
import csv
import json
import os
import sys

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, FOLDER)

from cases import CASES  # noqa: E402
from generate import write  # noqa: E402
from process import Process  # noqa: E402

TABLES = {"hits": "Closest hits: missed, false, or at a wrong distance", "occlusion": "Occlusion", "counts": "All hits: wrong numbers",
          "distances": "Points: wrong distances", "signs": "Points: wrong sides"}


def tracers():
    files = sorted(f[:-3] for f in os.listdir(os.path.join(FOLDER, "adapters")) if f.endswith(".py") and f[0] != "_")
    return sorted(files, key=lambda name: name != "claray")


def start(tracer, names, options):
    """A process that answers one tracer's cases."""
    command = [sys.executable, os.path.join(FOLDER, "worker.py"), tracer, options.cases, *names]
    return Process(command, os.path.join(options.cases, tracer + ".log"), dict(os.environ, HARDRAYS_TINYBVH=options.tinybvh))


def results_of(tracer, names, options):
    """The results by case, and the tracer's version or why there is none."""
    results, waiting, version = {}, list(names), ""
    while waiting:
        worker = start(tracer, waiting, options)
        line = worker.next(options.limit)
        if "version" not in line:
            worker.end()
            return {}, line.get("missing", line.get("stopped"))
        version = line["version"]
        while waiting:
            name, line = waiting.pop(0), worker.next(options.limit)
            results[name] = line
            print("%-16s %-16s %s" % (tracer, name, summary(line)), file=sys.stderr, flush=True)
            if line.get("stopped") in ("aborts", "hangs"):
                break
        worker.end()
    return results, version


def summary(line):
    return line.get("stopped") or ", ".join("%s %s" % (kind, line[kind].get("wrong", line[kind].get("stopped"))) for kind in TABLES if kind in line)


def cell(results, tracer, name, kind):
    line = results[tracer].get(name, {})
    found = line.get(kind)
    if not found:
        return line.get("stopped", "-")
    part = " of %d" % line["queries"] if "queries" in line else ""
    return "%d%s" % (found["wrong"], part) if "wrong" in found else found["stopped"]


def print_tables(results, names, versions):
    rows = []
    for kind, title in TABLES.items():
        columns = [t for t in results if any(kind in line for line in results[t].values())]
        lines = [[name, *(cell(results, t, name, kind) for t in columns)] for name in names]
        lines = [line for line in lines if any(c[0].isdigit() for c in line[1:])]
        if not lines:
            continue
        print("\n%s\n" % title)
        table = [["case", *columns], *lines]
        widths = [max(len(row[k]) for row in table) for k in range(len(columns) + 1)]
        for row in [table[0], ["-" * w for w in widths], *lines]:
            print("| " + " | ".join(value.ljust(w) if k == 0 else value.rjust(w) for k, (value, w) in enumerate(zip(row, widths))) + " |")
        rows += [[kind, line[0], tracer, versions[tracer], value] for line in lines for tracer, value in zip(columns, line[1:])]
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES), metavar="CASE")
    parser.add_argument("--tracer", nargs="+", choices=tracers(), default=tracers(), metavar="NAME")
    parser.add_argument("--cases", default="out/hardrays", help="the folder of the cases' files; those that are not there are written")
    parser.add_argument("--tinybvh", default="", help="a folder with tinybvh's tiny_bvh.h")
    parser.add_argument("--limit", type=float, default=120, help="seconds for one case")
    parser.add_argument("--json", help="all results, with the first wrong rays of each kind")
    parser.add_argument("--csv", help="the tables, a row for each cell")
    options = parser.parse_args()
    for name in options.only:
        if not os.path.exists(os.path.join(options.cases, name + ".npz")):
            write(name, options.cases)
    results, versions = {}, {}
    for tracer in options.tracer:
        results[tracer], versions[tracer] = results_of(tracer, options.only, options)
    for tracer in [t for t in results if not results[t]]:
        print("%s is left out: %s" % (tracer, versions[tracer]))
        del results[tracer]
    rows = print_tables(results, options.only, versions)
    print("\n" + ", ".join("%s %s" % (t, versions[t]) for t in results))
    if options.json:
        with open(options.json, "w") as file:
            json.dump({"versions": versions, "results": results}, file, indent=1)
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file).writerows([["table", "case", "tracer", "version", "wrong"], *rows])


if __name__ == "__main__":
    main()
