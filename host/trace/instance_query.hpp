// A query over arrays of rays against instances: its kernel for one structure and one set of options.
#pragma once

#include <algorithm>

#include "claray/instances.hpp"
#include "host/compute/programs/kernel_set.hpp"
#include "host/trace/query_options.hpp"

namespace claray {

/// What it is compiled from. `trees`: the format of the bottom levels.
[[nodiscard]] KernelRequest instance_kernel(const TreeFormat& trees, QueryKind kind, const QueryOptions& options);

class InstanceQuery {
public:
    using Kind = QueryKind;

    InstanceQuery() = default;
    /// The profiler shows its times under `name`, or under the kernel's name if `name` is empty.
    InstanceQuery(const InstancedBvh& bvh, Kind kind, const QueryOptions& options = {}, const std::string& name = {})
        : InstanceQuery(bvh.device(), bvh, kind, options, name) {}
    /// The same on another queue of the structure's context.
    InstanceQuery(const Device& queue, const InstancedBvh& bvh, Kind kind, const QueryOptions& options,
                  const std::string& name = {});

    /// Traces the first min(*count, capacity) rays, or `capacity` if `count` is absent; asynchronous. `results` holds
    /// InstanceHits or, for any hit, bytes. `times`, of the rays, may be absent.
    template <class Result>
    void run(const Buffer<Ray>& rays, Buffer<Result>& results, std::uint32_t capacity,
             const Buffer<std::uint32_t>& count, const Buffer<float>& times) {
        const Range range{(std::size_t(capacity) + rays_per_item_ - 1) / rays_per_item_, group_};
        if (kind_ == Kind::closest)
            kernel_.run(range, bvh_, rays, results, capacity, arg("count", count), arg("masks", options_.ray_masks),
                        arg("times", times), options_.visits);
        else
            kernel_.run(range, bvh_, rays, results, capacity, arg("count", count), arg("masks", options_.ray_masks),
                        arg("times", times));
    }

private:
    InstancedBvh bvh_;
    Kind kind_ = Kind::closest;
    QueryOptions options_;
    Kernel kernel_;
    std::size_t rays_per_item_ = 1, group_ = 64;
};

}  // namespace claray
