#include "claray/query.hpp"

#include "host/trace/query_options.hpp"

namespace claray {

void closest_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits, const QueryOptions& options,
                 const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), hits.size(), options);
    const auto capacity = std::uint32_t(rays.size());
    const Defines defines = query_defines(bvh.defines(), options);
    if (options.brute_force) {
        load_kernel(bvh.device(), "trace/brute_force.cl", "brute_force_closest_hit", defines)
            .run({capacity, 64}, bvh.header_buffer(), bvh.leaves(), rays, hits, capacity, count, options.ray_masks);
        return;
    }
    load_kernel(bvh.device(), "trace/closest_hit.cl", "closest_hit", defines)
        .run({capacity, bvh.device().tuning("trace/closest_hit", "GROUP_SIZE")}, bvh, rays, hits, capacity, count,
             options.ray_masks, options.visits);
}

void any_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, const QueryOptions& options,
             const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), occluded.size(), options);
    const auto capacity = std::uint32_t(rays.size());
    QueryOptions without_visits = options;
    without_visits.visits = {};
    const Defines defines = query_defines(bvh.defines(), without_visits);
    if (options.brute_force) {
        load_kernel(bvh.device(), "trace/brute_force.cl", "brute_force_any_hit", defines)
            .run({capacity, 64}, bvh.header_buffer(), bvh.leaves(), rays, occluded, capacity, count, options.ray_masks);
        return;
    }
    load_kernel(bvh.device(), "trace/any_hit.cl", "any_hit", defines)
        .run({capacity, bvh.device().tuning("trace/any_hit", "GROUP_SIZE")}, bvh, rays, occluded, capacity, count,
             options.ray_masks);
}

std::vector<Hit> closest_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    const Buffer<Ray> device_rays(bvh.device(), rays);
    Buffer<Hit> hits(bvh.device(), rays.size());
    closest_hit(bvh, device_rays, hits, options);
    return hits.read();
}

std::vector<std::uint8_t> any_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    const Buffer<Ray> device_rays(bvh.device(), rays);
    Buffer<std::uint8_t> occluded(bvh.device(), rays.size());
    any_hit(bvh, device_rays, occluded, options);
    return occluded.read();
}

}  // namespace claray
