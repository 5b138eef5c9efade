"""One tracer with one setting, which obeys lines of its standard input: ray_worker.py TRACER FOLDER. rays.py starts it.

`load NAME` reads a scene of the folder, `build` builds its tree, `prepare KIND` converts rays and traces them twice, `trace`
traces them. Each answer is a line of JSON, with seconds by the clock and of all threads: means of as many times as LEAST seconds
hold, since a time slice of a busy machine is longer than a build of a small scene.
"""

import importlib
import json
import os
import sys
import time
from importlib.metadata import PackageNotFoundError, version

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../hardrays"))
sys.path.insert(1, os.path.dirname(os.path.abspath(__file__)))

from ray_scenes import COHERENT  # noqa: E402


LEAST = 0.03


class State:
    def __init__(self, tracer, folder):
        self.tracer, self.folder = tracer, folder

    def load(self, name):
        self.path = os.path.join(self.folder, name)
        self.mesh = self.read("positions"), self.read("triangles")
        return {}

    def read(self, name):
        return np.load(os.path.join(self.path, name + ".npy"))

    def build(self):
        def task():
            self.scene = None  # so that no two trees are in memory
            self.scene = self.tracer.make(*self.mesh)
        return timed(task)

    def prepare(self, kind):
        ask = self.tracer.any_hit if kind == "shadow" else self.tracer.closest
        self.task = ask(self.scene, self.read(kind + "_origins"), self.read(kind + "_directions"), kind in COHERENT)
        self.task()
        return {"hits": self.tracer.count(self.task())}

    def trace(self):
        return timed(self.task)


def timed(task):
    begin, count = (time.perf_counter(), time.process_time()), 0
    while count == 0 or time.perf_counter() - begin[0] < LEAST:
        task()
        count += 1
    return {"seconds": (time.perf_counter() - begin[0]) / count, "processor": (time.process_time() - begin[1]) / count}


def obey(state, words):
    try:
        return getattr(state, words[0])(*words[1:])
    except Exception as error:
        print(repr(error), file=sys.stderr)
        return {"stopped": "refuses", "message": repr(error)[:300]}


def main():
    name, folder = sys.argv[1:]
    output = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the libraries print goes to the log
    try:
        tracer = importlib.import_module("tracers." + name)
        about = {"best": getattr(tracer, "BEST", "")}
        about["version"] = version(tracer.PACKAGE)
    except PackageNotFoundError:
        about["version"] = getattr(tracer, "VERSION", "of this clone")
    except Exception as error:
        about = {"missing": str(error)}
    print(json.dumps(about), file=output, flush=True)
    state = None if "missing" in about else State(tracer, folder)
    for line in sys.stdin if state else ():
        print(json.dumps(obey(state, line.split())), file=output, flush=True)


if __name__ == "__main__":
    main()
