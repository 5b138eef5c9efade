#include <algorithm>

#include "claray/instances.hpp"
#include "host/trace/query_options.hpp"

namespace claray {
namespace {

template <class... Arguments>
void trace(const InstancedBvh& bvh, const char* function, const QueryOptions& options, std::size_t rays,
           const Arguments&... arguments) {
    const Device& device = bvh.device();
    Defines defines = query_defines(bvh.defines(), options);
    if (options.brute_force) defines.emplace_back("EVERY_INSTANCE", "1");
    const std::size_t rays_per_item = std::max(1u, device.tuning("trace/instances", "RAYS_PER_ITEM"));
    load_kernel(device, "trace/instances.cl", function, defines)
        .run({(rays + rays_per_item - 1) / rays_per_item, device.tuning("trace/instances", "GROUP_SIZE")}, bvh,
             arguments...);
}

}  // namespace

void closest_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<InstanceHit>& hits,
                 const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), hits.size(), options);
    trace(bvh, "closest_hit_instances", options, rays.size(), rays, hits, std::uint32_t(rays.size()), count,
          options.ray_masks, options.visits);
}

void any_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), occluded.size(), options);
    QueryOptions without_visits = options;
    without_visits.visits = {};
    trace(bvh, "any_hit_instances", without_visits, rays.size(), rays, occluded, std::uint32_t(rays.size()), count,
          options.ray_masks);
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
