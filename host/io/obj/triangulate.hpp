// Polygons to triangles.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace claray {

/// Splits a polygon of n >= 3 points, convex or not, into n - 2 triangles of indices into `points` that keep its
/// orientation, by cutting off ears (Meisters 1975). A polygon that crosses itself or holds NaN still gives n - 2
/// triangles. Returns how often a point was looked at: about n for convex polygons, n log n for most others.
std::size_t triangulate(std::span<const glm::vec3> points, std::vector<glm::uvec3>& triangles);

}  // namespace claray
