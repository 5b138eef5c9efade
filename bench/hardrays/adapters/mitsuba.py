"""Mitsuba 3, variant llvm_ad_rgb, with its default settings."""

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
PACKAGE, LIMITS = "mitsuba", ("tmax",)


def make(positions, triangles, **settings):
    mesh = mi.Mesh("mesh", len(positions), len(triangles))
    params = mi.traverse(mesh)
    params["vertex_positions"], params["faces"] = positions.ravel(), triangles.ravel()
    params.update()
    return mi.load_dict({"type": "scene", "mesh": mesh, **settings})


def closest_hit(scene, origins, directions, tmax=np.inf):
    ray = mi.Ray3f(mi.Point3f(origins.T), mi.Vector3f(directions.T), mi.Float(tmax), 0, [])
    found = scene.ray_intersect_preliminary(ray, coherent=False)
    return np.array(found.is_valid()), np.array(found.t), np.array(found.prim_index)


def occluded(scene, origins, directions):
    return np.array(scene.ray_test(mi.Ray3f(mi.Point3f(origins.T), mi.Vector3f(directions.T))))
