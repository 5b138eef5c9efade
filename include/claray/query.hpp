// Queries: the closest hit of each ray, and whether a ray hits anything.
#pragma once

#include <span>
#include <vector>

#include "claray/bvh.hpp"
#include "claray/query/filter.hpp"

namespace claray {

/// Whether neighbouring rays in an array have similar directions, as camera rays do. Affects speed only.
enum class Coherence {
    automatic,  ///< decided by a sample of the rays; on GPUs, any-hit rays count as incoherent
    coherent,
    incoherent
};

struct QueryOptions {
    bool cull_back_faces = false;  ///< only triangles whose vertices appear counter-clockwise are hit
    bool brute_force = false;      ///< tests every triangle, without the tree: same hits, for comparison
    Coherence coherence = Coherence::automatic;
    Buffer<std::uint32_t> ray_masks;  ///< one per ray; empty: every ray sees every mesh
    Buffer<float> ray_times;          ///< one per ray, 0 to 1, for an InstancedBvh with motion; empty: time 0
    Buffer<Visits> visits;            ///< if allocated: receives the cost of each ray
    /// Of a Bvh without `brute_force` and `visits`: only hits that it accepts count. Rays are then traced one by one.
    HitFilter filter;
};

/// Finds the closest hit of every ray. Asynchronous, except on CPUs for 65,536 rays or more without a coherence hint:
/// there a sample of the rays is read first. Hits are equal bit for bit in all layouts: among equal distances the
/// lowest primitive index wins. `hits` must hold at least as many elements as `rays`. If `count` (one element on the
/// device) is given, only the first min(*count, rays.size()) rays are traced.
void closest_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits, const QueryOptions& options = {},
                 const Buffer<std::uint32_t>& count = {});
/// Writes 1 for every ray that hits anything, else 0. Asynchronous as closest_hit.
void any_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, const QueryOptions& options = {},
             const Buffer<std::uint32_t>& count = {});

/// As above, for rays in host memory: uploads, traces, downloads. Blocks.
[[nodiscard]] std::vector<Hit> closest_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const Bvh& bvh, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

}  // namespace claray
