#include "host/render/parts/parts_query.hpp"

#include "host/compute/memory.hpp"

namespace claray {

KernelRequest keeper_of_nearest(const StructureFormat& structure, QueryKind kind) {
    return {"render/parts/keep_nearest.cl", kind == QueryKind::closest ? "keep_nearest" : "keep_blocked",
            structure.defines()};
}

PartsQuery::PartsQuery(const Structure& structure, QueryKernel::Kind kind, const QueryOptions& options,
                       const std::string& name)
    : parts_(structure.parts()), structure_(structure), visits_(options.visits) {
    for (const SceneParts::Part& part : parts_->parts())
        part.instanced ? void(of_instances_.emplace_back(*part.instanced, kind, options, name))
                       : void(of_triangles_.emplace_back(part.bvh, kind, options, name));
    keep_ = load_kernel(structure.device(), keeper_of_nearest(structure.format(), kind));
    if (visits_.allocated()) visits_of_all_ = Buffer<Visits>(structure.device(), visits_.size());
}

/// Reading their number waits for the device, but copying parts for no rays takes longer.
std::uint32_t PartsQuery::rays_to_trace(std::uint32_t capacity, const Buffer<std::uint32_t>& count) const {
    return count.allocated() && parts_->take_turns() ? std::min(capacity, count.read()[0]) : capacity;
}

void PartsQuery::closest(const Buffer<Ray>& rays, SceneHits& hits, std::uint32_t capacity,
                         const Buffer<std::uint32_t>& count, const Buffer<float>& times) {
    capacity = rays_to_trace(capacity, count);
    if (capacity == 0) return;
    if (found_.size() < capacity) found_ = SceneHits(structure_, rays.size());
    parts_->for_each([&](std::size_t i, bool first) {
        structure_.instanced() ? of_instances_[i].run(rays, found_.of_instances, capacity, count, times)
                               : of_triangles_[i].run(rays, found_.of_triangles, capacity, count);
        keep_.run({capacity, 64}, arg("count", count), capacity, arg("found", found_),
                  arg("numbers", parts_->parts()[i].instance_numbers), std::uint32_t(first), arg("nearest", hits), rays,
                  arg("visits", visits_), arg("sum", visits_of_all_));
    });
}

void PartsQuery::any(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::uint32_t capacity,
                     const Buffer<std::uint32_t>& count, const Buffer<float>& times) {
    capacity = rays_to_trace(capacity, count);
    if (capacity == 0) return;
    blocked_.reserve(structure_.device(), std::max<std::size_t>(capacity, rays.size()));
    parts_->for_each([&](std::size_t i, bool first) {
        structure_.instanced() ? of_instances_[i].run(rays, blocked_, capacity, count, times)
                               : of_triangles_[i].run(rays, blocked_, capacity, count);
        keep_.run({capacity, 64}, arg("count", count), capacity, arg("found", blocked_), std::uint32_t(first),
                  arg("occluded", occluded), rays);
    });
}

std::uint64_t PartsQuery::bytes() const { return buffer_bytes(visits_, visits_of_all_, found_, blocked_); }

}  // namespace claray
