// Kernels with a program's filter of hits.
#pragma once

#include "claray/query.hpp"

namespace claray {

/// Loads a kernel of a file that includes kernels/trace/lists/each_hit.clh, with the filter of the options if there is
/// one.
[[nodiscard]] Kernel load_filtered(const Device& device, const std::string& file, const std::string& function,
                                   const Defines& defines, const HitFilter& filter);

/// Binds FILTER_PARAMETER of kernels/trace/lists/each_hit.clh, if there is a filter.
struct FilterData {
    const HitFilter& filter;
    void bind(Kernel& kernel, unsigned& index) const {
        if (!filter.source.empty()) kernel.set(index, arg("filter_data", filter.data));
    }
};

/// Queries with the filter of the options, on a queue of the structure's context.
void closest_accepted(const Device& queue, const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits,
                      const QueryOptions& options, const Buffer<std::uint32_t>& count);
void any_accepted(const Device& queue, const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
                  const QueryOptions& options, const Buffer<std::uint32_t>& count);

}  // namespace claray
