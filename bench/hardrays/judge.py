"""Counts wrong answers. README.md has the rules."""

import numpy as np

from answers import EITHER, HIT, MISS


def shortened(case, most):
    """The case's first queries."""
    out, queries = dict(case), len(case.get("points", case.get("origins")))
    for name in ("points", "squared_distance", "inside", "origins", "directions", "tmin", "tmax", "expect", "count", "parity"):
        if name in case:
            out[name] = case[name][:most]
    if "first" in case:
        out["first"] = case["first"][:most + 1]
        last = out["first"][-1]
    for name in ("primitive", "t", "tolerance"):
        if name in case:
            out[name] = case[name][:last if "first" in case else most]
    return out, min(most, queries)


def hits(case, hit, t, primitive):
    """Numbers of rays that miss what they must hit, hit what they must miss, and have a wrong distance or only a wrong triangle."""
    hit, t, primitive = np.asarray(hit, bool), np.asarray(t, np.float64), np.asarray(primitive).astype(np.int64)
    count = len(case["expect"])
    ray = np.repeat(np.arange(count), np.diff(case["first"].astype(np.int64)))
    near = abs(t[ray] - case["t"]) <= case["tolerance"]
    near_ray = np.bincount(ray, near, count) > 0
    same_ray = np.bincount(ray, near & (primitive[ray] == case["primitive"]), count) > 0
    answered = hit & (case["expect"] != MISS)
    wrong = {"missed": ~hit & (case["expect"] == HIT), "false": hit & (case["expect"] == MISS), "distance": answered & ~near_ray}
    found = {name: int(rows.sum()) for name, rows in wrong.items()}
    found["wrong"] = sum(found.values())
    found["primitive"] = int((answered & near_ray & ~same_ray).sum())
    found["first"] = first_rows(wrong)
    return found


def first_rows(wrong, most=3):
    """The first rays of each fault."""
    return {name: np.flatnonzero(rows)[:most].tolist() for name, rows in wrong.items() if rows.any()}


def occlusion(case, occluded):
    occluded = np.asarray(occluded, bool)
    wrong = (occluded & (case["expect"] == MISS)) | (~occluded & (case["expect"] == HIT))
    return {"wrong": int(wrong.sum()), "first": first_rows({"occlusion": wrong})}


def counts(case, count):
    count, right = np.asarray(count).astype(np.int64), case["count"]
    wrong = np.where(right >= 0, count != right, (case["parity"] >= 0) & (count % 2 != case["parity"]))
    return {"wrong": int(wrong.sum()), "first": first_rows({"count": wrong})}


def distances(case, distance):
    wrong = ~(abs(np.asarray(distance, np.float64) - np.sqrt(case["squared_distance"])) <= case["tolerance"])
    return {"wrong": int(wrong.sum()), "first": first_rows({"distance": wrong})}


def signs(case, inside):
    wrong = (case["inside"] != EITHER) & (np.asarray(inside, bool) != (case["inside"] == 1))
    return {"wrong": int(wrong.sum()), "first": first_rows({"sign": wrong})}
