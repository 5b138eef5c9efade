// Queries learn: after many rays a tree is replaced by a better one, see Bvh::Config::learns.
#pragma once

#include <functional>

#include "claray/query.hpp"

namespace claray {

/// Calls `trace` with the tree that a query of so many rays on the queue of `queue` should trace: `bvh`, or the better
/// one that has replaced it. While the two are compared, calls it with each of them: both give the same results.
/// Asynchronous if `trace` is.
void trace_and_learn(const Device& queue, const Bvh& bvh, const QueryOptions& options, std::size_t rays,
                     const Buffer<std::uint32_t>& count, const std::function<void(const Bvh&)>& trace);

/// Waits until no better tree is being built. For tests.
void wait_for_build(const Bvh& bvh);

}  // namespace claray
