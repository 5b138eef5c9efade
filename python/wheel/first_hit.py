"""What check.py runs in a bare system: prints how long the import takes, whether a ray hits, and which libraries are loaded."""

import json
import re
import sys
import time

import numpy

begin = time.perf_counter()
import claray  # noqa: E402

found = {"import_seconds": time.perf_counter() - begin, "version": claray.__version__, "python": sys.version.split()[0]}
try:
    bvh = claray.Bvh(numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "f4"), numpy.array([[0, 1, 2]], "u4"))
    found["t"] = float(claray.closest_hit(bvh, [[0.2, 0.2, 1]], [[0, 0, -1]])["t"][0])
    found["device"] = bvh.device.name
    image = claray.render(claray.load("cornell"), width=32, height=32, spp=1)
    found["mean"] = float(image.mean())
except claray.DeviceError as error:
    found["error"] = str(error)
with open("/proc/self/maps", encoding="utf-8") as maps:
    found["libraries"] = sorted(set(re.findall(r"(/\S+\.so[.\d]*)$", maps.read(), re.M)))
print(json.dumps(found))
