// Queries learn: after many rays a tree is replaced by a better one, see Bvh::Config::learns.
#pragma once

#include "claray/query.hpp"

namespace claray {

/// The tree that a query of these rays on the queue of `queue` should trace: `bvh`, or the better one that has replaced
/// it. Counts the rays and takes a sample of them. Asynchronous.
[[nodiscard]] Bvh learned_tree(const Device& queue, const Bvh& bvh, QueryKind kind, const QueryOptions& options,
                               const Buffer<Ray>& rays, const Buffer<std::uint32_t>& count);

/// Waits until the search for a better tree has ended or waits for more rays. For tests and benchmarks.
void wait_for_search(const Bvh& bvh);

}  // namespace claray
