"""How often the answers of claray.warp differ from those of Warp on the CPU.

    python bench/python/warp_agreement.py [--queries N]

Random rays and points, and five meshes, each turned at random: a ball, the same with each vertex moved in or out by up to 20 %, a
torus, half of a ball, and 300 triangles anywhere. Needs warp-lang and trimesh.
"""

import argparse
import os
import sys

import numpy as np
import trimesh
import warp as wp

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tests/python/drop_ins"))

from warp_peer import QUERIES, Peer  # noqa: E402

import claray.warp  # noqa: E402


def meshes(rng):
    ball, torus = trimesh.creation.icosphere(subdivisions=4), trimesh.creation.torus(1, 0.4)
    corners = rng.uniform(-1, 1, (300, 1, 3)) + rng.uniform(-0.3, 0.3, (300, 3, 3))
    return {"ball": (ball.vertices, ball.faces), "rough ball": (ball.vertices * rng.uniform(0.8, 1.2, (len(ball.vertices), 1)), ball.faces),
            "torus": (torus.vertices, torus.faces), "half ball": (ball.vertices, ball.faces[ball.triangles_center[:, 2] > 0]),
            "triangles": (corners.reshape(-1, 3), np.arange(900).reshape(-1, 3))}


def largest(a, b, rows):
    return float(np.abs(a - b)[rows].max(initial=0))


def compare_rays(peer, mesh, start, towards):
    ours = claray.warp.mesh_query_ray(mesh, start, towards, 1.5)
    given = (wp.array(array, dtype=wp.vec3) for array in (start, towards))
    result, sign, face, t, u, v, normal = (array.numpy() for array in peer.rays(*given, 1.5))
    same = result & ours.result & (face == ours.face)
    print(f"  rays: {result.sum()} hits; other: result {(result != ours.result).sum()}, face {(result & ours.result & ~same).sum()}, "
          f"sign {(np.sign(sign) != ours.sign)[same].sum()}; largest difference: t {largest(t, ours.t, same):.0e}, "
          f"u {largest(u, ours.u, same):.0e}, v {largest(v, ours.v, same):.0e}, normal {largest(normal, ours.normal, same):.0e}")


def compare_points(peer, mesh, points, name):
    ours = getattr(claray.warp, name)(mesh, points, 0.8)
    result, sign, *place = (array.numpy() for array in peer.points_by(name, wp.array(points, dtype=wp.vec3), 0.8))
    both = result & ours.result
    places = (claray.warp.mesh_eval_position(mesh, *at) for at in (place, ours[2:]))
    distances = [np.linalg.norm(at - points, axis=1) for at in places]
    print(f"  {name}: {result.sum()} found; other: result {(result != ours.result).sum()}, sign {(sign != ours.sign)[both].sum()}; "
          f"largest difference: distance {largest(*distances, both):.0e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--queries", type=int, default=100_000)
    count = parser.parse_args().queries
    wp.config.quiet = True
    rng = np.random.default_rng(5)
    for title, (vertices, triangles) in meshes(rng).items():
        turn = trimesh.transformations.random_rotation_matrix(rng.random(3))[:3, :3]
        vertices = (vertices @ turn).astype(np.float32)
        peer, mesh = Peer(vertices, triangles), claray.warp.Mesh(vertices, triangles, support_winding_number=True)
        points = rng.uniform(-1.4, 1.4, (count, 3)).astype(np.float32)
        towards = (rng.uniform(-1, 1, (count, 3)) - points * rng.random((count, 1))).astype(np.float32)
        print(f"{title}, {len(triangles)} triangles")
        compare_rays(peer, mesh, points, towards)
        for name in QUERIES:
            compare_points(peer, mesh, points, name)


if __name__ == "__main__":
    main()
