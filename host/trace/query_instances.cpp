#include "host/trace/instance_query.hpp"

#include "host/bvh/instances_state.hpp"

namespace claray {

KernelRequest instance_kernel(const TreeFormat& trees, QueryKind kind, const QueryOptions& options) {
    Defines defines = query_defines(trees.defines(), options);
    if (options.brute_force) defines.emplace_back("EVERY_INSTANCE", "1");
    return {"trace/instances.cl", kind == QueryKind::closest ? "closest_hit_instances" : "any_hit_instances", defines};
}

InstanceQuery::InstanceQuery(const Device& device, const InstancedBvh& bvh, Kind kind, const QueryOptions& options,
                             const std::string& name)
    : bvh_(bvh), kind_(kind), options_(options) {
    if (!options.filter.source.empty())
        throw Error(ErrorKind::usage, "queries of instances have no filter of hits", "filter hits of a Bvh");
    if (kind == Kind::any) options_.visits = {};
    kernel_ = load_kernel(device, instance_kernel(state_of(bvh).format, kind, options_));
    if (!name.empty()) kernel_ = Kernel(device, kernel_.handle(), name);
    rays_per_item_ = std::max(1u, device.tuning("trace/instances", "RAYS_PER_ITEM"));
    group_ = device.tuning("trace/instances", "GROUP_SIZE");
}

void closest_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<InstanceHit>& hits,
                 const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), hits.size(), options);
    InstanceQuery(bvh, InstanceQuery::Kind::closest, options)
        .run(rays, hits, std::uint32_t(rays.size()), count, options.ray_times);
}

void any_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    check_sizes(rays.size(), occluded.size(), options);
    InstanceQuery(bvh, InstanceQuery::Kind::any, options)
        .run(rays, occluded, std::uint32_t(rays.size()), count, options.ray_times);
}

std::vector<InstanceHit> closest_hit(const InstancedBvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    return answers<InstanceHit, InstancedBvh>(bvh, rays, options, closest_hit);
}

std::vector<std::uint8_t> any_hit(const InstancedBvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    return answers<std::uint8_t, InstancedBvh>(bvh, rays, options, any_hit);
}

}  // namespace claray
