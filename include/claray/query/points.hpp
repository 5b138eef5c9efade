// Queries by points: the nearest point of a surface.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "claray/bvh.hpp"

namespace claray {

struct PointOptions {
    float reach = std::numeric_limits<float>::infinity();  ///< the largest distance at which a point is found
    bool brute_force = false;  ///< tests every triangle: same answers, for comparison; binary layout only
    bool sort = true;  ///< answer points in an order in which neighbours are near each other. Affects speed only
    Buffer<std::uint32_t> masks{};  ///< one per point; empty: every point sees every mesh
    Buffer<Visits> visits{};        ///< if allocated: receives the cost of each point
};

/// Finds the point of the surface that is nearest to each point. `points` holds 3 floats per point; `nearest` must hold
/// as many elements as there are points. Asynchronous.
///
/// Distances are computed in float64 and rounded to float32; their error before rounding is at most 2^-50 of the
/// distance to the triangle's farthest vertex. Among equal rounded distances the lowest primitive index wins, so that
/// the answers are equal bit for bit in all layouts. Triangles that the structure leaves out (see
/// BvhStatistics::culled) are not found. A point that is not finite finds nothing. Throws ErrorKind::usage if a buffer
/// has the wrong size.
void nearest_point(const Bvh& bvh, const Buffer<float>& points, Buffer<NearestPoint>& nearest,
                   const PointOptions& options = {});
/// As above, for points in host memory: uploads, searches, downloads. Blocks.
[[nodiscard]] std::vector<NearestPoint> nearest_point(const Bvh& bvh, std::span<const glm::vec3> points,
                                                      const PointOptions& options = {});

}  // namespace claray
