"""Builds a mesh and traces 100,000 rays by one tracer, then ends: first_rays.py TRACER. cold.py starts it. Exit code 2: not there."""

import importlib
import os
import sys

import numpy as np

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [FOLDER, os.path.join(FOLDER, "../hardrays")]

from shapes import grid  # noqa: E402

try:
    tracer = importlib.import_module("tracers." + sys.argv[1])
except (ImportError, FileNotFoundError) as error:
    print(error, file=sys.stderr)
    sys.exit(2)
x, y = np.meshgrid(np.arange(226), np.arange(226), indexing="ij")
positions, triangles = grid(np.sin(x / 9.0) * np.cos(y / 7.0))
rng = np.random.default_rng(1)
origins = np.concatenate([rng.uniform(0, 225, (100_000, 2)), np.full((100_000, 1), 9.0)], 1).astype(np.float32)
directions = np.tile(np.array([0.01, 0.02, -1], np.float32), (100_000, 1))
scene = tracer.make(positions, triangles)
hits = tracer.count(tracer.closest(scene, origins, directions, True)())
if hits < 98_000:
    sys.exit("%d hits, too few" % hits)
sys.stdout.flush()
os._exit(0)  # an answer is there: not the time in which libraries end
