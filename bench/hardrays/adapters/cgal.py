"""CGAL's AABB tree. Its Python bindings have no first intersection: the nearest of all is taken here."""

import numpy as np
from CGAL.CGAL_AABB_tree import AABB_tree_Triangle_3_soup
from CGAL.CGAL_Kernel import Point_3, Ray_3, Triangle_3, Vector_3

PACKAGE = "cgal"
points_of = lambda values: (Point_3(*p) for p in values.astype(np.float64).tolist())
rays_of = lambda o, d: (Ray_3(p, Vector_3(*v)) for p, v in zip(points_of(o), d.astype(np.float64).tolist()))


def make(positions, triangles):
    return AABB_tree_Triangle_3_soup([Triangle_3(*points_of(corners)) for corners in positions[triangles]])


def closest_hit(tree, origins, directions):
    out = []
    for o, d, ray in zip(origins.astype(np.float64), directions.astype(np.float64), rays_of(origins, directions)):
        found = []
        tree.all_intersections(ray, found)
        places = [(x.first.get_Point_3() if x.first.is_Point_3() else x.first.get_Segment_3().source(), x.second) for x in found]
        out.append(min([(np.dot([p.x(), p.y(), p.z()] - o, d) / (d @ d), k) for p, k in places], default=(0.0, -1)))
    t, primitive = (np.array(column) for column in zip(*out))
    return primitive != -1, t, primitive


occluded = lambda tree, origins, directions: np.array([tree.do_intersect(ray) for ray in rays_of(origins, directions)])
distance = lambda tree, points: np.sqrt([tree.squared_distance(p) for p in points_of(points)])
