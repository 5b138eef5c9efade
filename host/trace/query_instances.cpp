#include "claray/instances.hpp"
#include "host/trace/query_options.hpp"

namespace claray {
namespace {

constexpr const char* file = "trace/instances.cl";

Defines defines_for(const InstancedBvh& bvh, const QueryOptions& options) {
    Defines defines = query_defines(bvh.defines(), options);
    if (options.brute_force) defines.emplace_back("EVERY_INSTANCE", "1");
    return defines;
}

}  // namespace

void closest_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<InstanceHit>& hits,
                 const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), hits.size(), options);
    load_kernel(bvh.device(), file, "closest_hit_instances", defines_for(bvh, options))
        .run({rays.size(), bvh.device().tuning("trace/instances", "GROUP_SIZE")}, bvh, rays, hits,
             std::uint32_t(rays.size()), count, options.ray_masks, options.visits);
}

void any_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), occluded.size(), options);
    QueryOptions without_visits = options;
    without_visits.visits = {};
    load_kernel(bvh.device(), file, "any_hit_instances", defines_for(bvh, without_visits))
        .run({rays.size(), bvh.device().tuning("trace/instances", "GROUP_SIZE")}, bvh, rays, occluded,
             std::uint32_t(rays.size()), count, options.ray_masks);
}

std::vector<InstanceHit> closest_hit(const InstancedBvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    const Buffer<Ray> device_rays(bvh.device(), rays);
    Buffer<InstanceHit> hits(bvh.device(), rays.size());
    closest_hit(bvh, device_rays, hits, options);
    return hits.read();
}

std::vector<std::uint8_t> any_hit(const InstancedBvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    const Buffer<Ray> device_rays(bvh.device(), rays);
    Buffer<std::uint8_t> occluded(bvh.device(), rays.size());
    any_hit(bvh, device_rays, occluded, options);
    return occluded.read();
}

}  // namespace claray
