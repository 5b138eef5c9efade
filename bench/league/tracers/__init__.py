"""The tracers of rays.py, one a file. A process runs one of them, with one setting.

`make` builds, `closest` and `any_hit` return functions that trace and wait, `count` counts the hits of their results. `BEST` says
what differs where `best` is true: it is missing if the default setting is the best. `coherent`: primary rays.
"""

import os

best = os.environ.get("LEAGUE_SETTING") == "best"
cores = len(os.sched_getaffinity(0))
