#include "claray/query.hpp"

#include "host/trace/learning/learning.hpp"
#include "host/trace/lists/filter.hpp"
#include "host/trace/query_kernel.hpp"

namespace claray {

void closest_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits, const QueryOptions& options,
                 const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), hits.size(), options);
    if (!options.filter.source.empty()) return closest_accepted(bvh.device(), bvh, rays, hits, options, count);
    trace_and_learn(bvh.device(), bvh, options, rays.size(), count, [&](const Bvh& tree) {
        QueryKernel(bvh.device(), tree, QueryKind::closest, options).run(rays, hits, std::uint32_t(rays.size()), count);
    });
}

void any_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, const QueryOptions& options,
             const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), occluded.size(), options);
    if (!options.filter.source.empty()) return any_accepted(bvh.device(), bvh, rays, occluded, options, count);
    trace_and_learn(bvh.device(), bvh, options, rays.size(), count, [&](const Bvh& tree) {
        QueryKernel(bvh.device(), tree, QueryKind::any, options).run(rays, occluded, std::uint32_t(rays.size()), count);
    });
}

std::vector<Hit> closest_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    return answers<Hit, Bvh>(bvh, rays, options, closest_hit);
}

std::vector<std::uint8_t> any_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    return answers<std::uint8_t, Bvh>(bvh, rays, options, any_hit);
}

}  // namespace claray
