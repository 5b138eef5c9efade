// Queries by points: the nearest point of a surface, whether a point is inside, and its signed distance.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "claray/bvh.hpp"

#pragma GCC visibility push(default)
namespace claray {

struct PointOptions {
    float reach = std::numeric_limits<float>::infinity();  ///< the largest distance at which a point is found
    bool brute_force = false;  ///< tests every triangle: same answers, for comparison; binary layout only
    bool sort = true;  ///< answer points in an order in which neighbours are near each other. Affects speed only
    /// `inside` and `signed_distance` of surfaces that are not closed (is_closed): the majority of 16 rays in
    /// different directions decides, instead of one. Takes 16 times as long.
    bool vote = false;
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

/// Writes 1 for every point inside of the closed mesh, else 0: whether the ray from the point along +z crosses the
/// surface an odd number of times. `answers` must hold an element per point. Each crossing counts once, also at edges
/// and vertices. In float64 the answer is exact (docs/numerics.md); a point on the surface may be either. If the meshes
/// are not closed (is_closed) or overlap each other, the answer is still that parity. Of `options` only `vote` is
/// used. Asynchronous, except with `vote` and for structures with split triangles (Bvh::Config::split_budget).
void inside(const Bvh& bvh, const Buffer<float>& points, Buffer<std::uint8_t>& answers,
            const PointOptions& options = {});

/// Writes the distance of every point to the surface, as nearest_point, negative inside. Farther than the reach of
/// `options`, it is that reach. Asynchronous as `inside`.
void signed_distance(const Bvh& bvh, const Buffer<float>& points, Buffer<float>& distances,
                     const PointOptions& options = {});

/// As above, for points in host memory.
[[nodiscard]] std::vector<std::uint8_t> inside(const Bvh& bvh, std::span<const glm::vec3> points,
                                               const PointOptions& options = {});
[[nodiscard]] std::vector<float> signed_distance(const Bvh& bvh, std::span<const glm::vec3> points,
                                                 const PointOptions& options = {});

}  // namespace claray
#pragma GCC visibility pop
