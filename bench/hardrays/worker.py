"""Runs one tracer on cases and prints a line of JSON for each: worker.py TRACER FOLDER CASE... run.py starts it."""

import importlib
import json
import os
import sys
import time
from importlib.metadata import PackageNotFoundError, version

import numpy as np

import judge


def answers_to_rays(adapter, scene, case):
    rays = case["origins"], case["directions"]
    if "tmax" not in case:
        yield "hits", lambda: judge.hits(case, *adapter.closest_hit(scene, *rays))
        if hasattr(adapter, "occluded"):
            yield "occlusion", lambda: judge.occlusion(case, adapter.occluded(scene, *rays))
    elif hasattr(adapter, "LIMITS"):
        yield "hits", lambda: judge.hits(*with_limits(adapter, scene, case, rays))
    if hasattr(adapter, "count_hits") and "count" in case:
        yield "counts", lambda: judge.counts(case, adapter.count_hits(scene, *rays))


def with_limits(adapter, scene, case, rays):
    """The case and the answers; without the rays with tmin, where the tracer has no such limit."""
    hit, t, primitive = adapter.closest_hit(scene, *rays, **{name: case[name] for name in adapter.LIMITS})
    ignored = (case["tmin"] > 0) & ("tmin" not in adapter.LIMITS)
    return dict(case, expect=np.where(ignored, judge.MISS, case["expect"])), hit & ~ignored, t, primitive


def answers_to_points(adapter, scene, case):
    if hasattr(adapter, "distance"):
        yield "distances", lambda: judge.distances(case, adapter.distance(scene, case["points"]))
    if hasattr(adapter, "inside"):
        yield "signs", lambda: judge.signs(case, adapter.inside(scene, case["points"]))


def refusal(error):
    print(repr(error), file=sys.stderr)
    return {"stopped": "refuses", "message": repr(error)[:300]}


def run(adapter, path):
    (case, queries), line = judge.shortened(dict(np.load(path)), getattr(adapter, "MOST", 1 << 30)), {}
    if hasattr(adapter, "MOST"):
        line["queries"] = queries
    try:
        scene = adapter.make(case["positions"], case["triangles"])
    except Exception as error:
        return refusal(error)
    for kind, answer in (answers_to_points if "points" in case else answers_to_rays)(adapter, scene, case):
        begin = time.perf_counter()
        try:
            line[kind] = answer()
        except Exception as error:
            line[kind] = refusal(error)
        line[kind]["seconds"] = round(time.perf_counter() - begin, 3)
    return line


def main():
    tracer, folder, *names = sys.argv[1:]
    output = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the libraries print goes to the log
    try:
        adapter = importlib.import_module("adapters." + tracer)
        about = {"version": version(adapter.PACKAGE)}
    except PackageNotFoundError:
        about = {"version": getattr(adapter, "VERSION", "of this clone")}
    except (ImportError, FileNotFoundError) as error:
        about = {"missing": str(error)}
    print(json.dumps(about), file=output, flush=True)
    if "missing" not in about:
        for name in names:
            print(json.dumps(run(adapter, os.path.join(folder, name + ".npz"))), file=output, flush=True)


if __name__ == "__main__":
    main()
