"""Mitsuba 3, variant llvm_ad_rgb: Embree in packets, on all cores."""

import drjit as dr
import numpy as np

from adapters.mitsuba import make, mi  # noqa: F401
from tracers import best

PACKAGE, BEST = "mitsuba", "frozen kernels, and primary rays marked as coherent"


def closest(scene, origins, directions, coherent):
    return task(lambda rays: scene.ray_intersect_preliminary(rays, coherent=best and coherent), origins, directions, np.inf)


def any_hit(scene, origins, directions, coherent):
    return task(lambda rays: scene.ray_test(rays, coherent=best and coherent), origins, directions, 1.0)


def task(ask, origins, directions, tmax):
    rays, ask = mi.Ray3f(mi.Point3f(origins.T), mi.Vector3f(directions.T), mi.Float(tmax), 0, []), dr.freeze(ask) if best else ask
    dr.eval(rays)

    def trace():
        found = ask(rays)
        dr.eval(found)
        dr.sync_thread()
        return found
    return trace


def count(found):
    return int(np.count_nonzero(np.array(found.is_valid() if hasattr(found, "is_valid") else found)))
