// Queries: what does each ray hit first, and does it hit anything at all.
#pragma once

#include <span>
#include <vector>

#include "claray/bvh.hpp"

namespace claray {

/// Whether neighbouring rays of an array point the same way, as a camera's do. Only speed depends on it.
enum class Coherence {
    automatic,  ///< a sample of the rays decides; any-hit rays on GPUs count as incoherent, since they end far apart
    coherent,
    incoherent
};

struct QueryOptions {
    bool cull_back_faces = false;  ///< only triangles whose vertices appear counterclockwise are hit
    bool brute_force = false;      ///< tests every triangle, without the tree: same hits, for comparison
    Coherence coherence = Coherence::automatic;
    Buffer<std::uint32_t> ray_masks;  ///< per ray; empty: every ray sees every mesh
    Buffer<float> ray_times;          ///< per ray, 0 to 1, for an InstancedBvh in motion; empty: all are of time 0
    Buffer<Visits> visits;            ///< where allocated, receives what each ray cost
};

/// The first hit of every ray; enqueued, not waited for (on CPUs a sample of arrays of 65,536 rays and more is, unless
/// `coherence` says how they lie). Hits are the same bit for bit on every layout: among equal
/// distances the lowest primitive wins. `hits` must hold as many elements as `rays`. With `count` (one element on the
/// device) only the first min(*count, rays.size()) rays are traced.
void closest_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits, const QueryOptions& options = {},
                 const Buffer<std::uint32_t>& count = {});
/// 1 for every ray that hits anything, else 0.
void any_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, const QueryOptions& options = {},
             const Buffer<std::uint32_t>& count = {});

/// The same for rays in host memory: uploads, traces, downloads.
[[nodiscard]] std::vector<Hit> closest_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const Bvh& bvh, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

}  // namespace claray
