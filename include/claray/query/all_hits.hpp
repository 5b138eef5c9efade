// Queries for all hits of a ray: their number, the nearest of them, a list.
#pragma once

#include "claray/query.hpp"
#include "claray/query/lists.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Counts the triangles that each ray hits at tmin < t <= tmax: as exact as closest_hit, a ray through an edge counts
/// once. With QueryOptions::closed every triangle counts that contains the hit point, so that a ray through an edge
/// counts twice. `counts` must hold at least as many elements as `rays`. Of `options` only `cull_back_faces`, `closed`,
/// `ray_masks` and `filter` are used. Asynchronous, except for structures with split triangles
/// (Bvh::Config::split_budget).
void count_hits(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint32_t>& counts,
                const QueryOptions& options = {});

/// Finds the `most` nearest hits of each ray, in order of distance, at equal distances of primitives. Those of ray i
/// are hits[i * most] .. hits[i * most + counts[i] - 1]; the elements behind them are not written. `hits` must hold
/// `most` elements per ray, `counts` one. Options as for count_hits. Asynchronous.
void nearest_hits(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t most, Buffer<Hit>& hits,
                  Buffer<std::uint32_t>& counts, const QueryOptions& options = {});

/// Finds all hits of each ray, in the same order. Options as for count_hits. Blocks to learn how many there are. Throws
/// ErrorKind::usage if there are more than 4e9.
[[nodiscard]] Lists<Hit> all_hits(const Bvh& bvh, const Buffer<Ray>& rays, const QueryOptions& options = {});

/// As above, for rays in host memory.
[[nodiscard]] std::vector<std::uint32_t> count_hits(const Bvh& bvh, std::span<const Ray> rays,
                                                    const QueryOptions& options = {});
[[nodiscard]] HostLists<Hit> all_hits(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options = {});

}  // namespace claray
#pragma GCC visibility pop
