#include "host/bvh/require_memory.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/compute/memory.hpp"

namespace claray {
namespace {

/// The memory that the constructor of the state would allocate: it runs without creating buffers.
BvhMemory plan_state(const Device& device, const TriangleBuffers& triangles, const Bvh::Config& config) {
    const MemoryPlan plan(device);
    const Bvh::State state(device, triangles, config);
    return {plan.bytes(), plan.largest()};
}

BvhMemory plan_all(const Device& device, const TriangleCounts& counts, const Bvh::Config& config) {
    const MemoryPlan plan(device);
    const Bvh::State state(device, allocate_triangles(device, counts), config);
    return {plan.bytes(), plan.largest()};
}

bool fits(const Device& device, const BvhMemory& memory) {
    return memory.bytes <= bytes_available(device) && gives_buffer(device, memory.largest_buffer);
}

/// `plan` returns the memory of a configuration.
template <class Plan>
void require(const Device& device, std::uint64_t triangles, const Bvh::Config& config, const Plan& plan) {
    const BvhMemory needed = plan(config);
    if (fits(device, needed)) return;
    const DeviceInfo& info = device.info();
    std::string why = "out of device memory: a tree of " + std::to_string(triangles) + " triangles needs ";
    if (needed.bytes > bytes_available(device))
        why += size_text(needed.bytes) + " on " + info.name + ", which has " + size_text(bytes_available(device)) +
               " of its " + size_text(info.memory) + " left";
    else
        why += "a buffer of " + size_text(needed.largest_buffer) + ", but " + info.name + " allocates at most " +
               size_text(info.max_allocation) + " per buffer";
    Bvh::Config least = config;
    least.builder = Builder::fast, least.layout = Layout::binary, least.morton_bits = 30;
    const BvhMemory smaller = plan(least);
    const std::string remedy = "choose the builder fast, the binary layout and codes of 30 bits, which need " +
                               size_text(smaller.bytes) + ", or another device";
    throw Error(ErrorKind::device, why,
                fits(device, smaller) ? remedy : "use fewer triangles, or a device with more memory");
}

}  // namespace

TriangleBuffers allocate_triangles(const Device& device, const TriangleCounts& counts) {
    TriangleBuffers triangles;
    triangles.positions = Buffer<float>(device, counts.positions);
    triangles.indices = Buffer<std::uint32_t>(device, counts.indices);
    if (counts.geometries > 0) triangles.geometries = Buffer<std::uint32_t>(device, counts.geometries);
    if (counts.masks > 0) triangles.masks = Buffer<std::uint32_t>(device, counts.masks);
    return triangles;
}

void require_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config) {
    require(device, counts.indices / 3, config,
            [&](const Bvh::Config& with) { return plan_all(device, counts, with); });
}

void require_memory(const Device& device, std::span<const Mesh> meshes, const Bvh::Config& config) {
    TriangleCounts counts;
    for (const Mesh& mesh : meshes)
        counts.positions += 3 * mesh.positions.size(), counts.indices += 3 * mesh.triangles.size();
    if (meshes.size() > 1) counts.geometries = counts.indices / 3;
    if (std::any_of(meshes.begin(), meshes.end(), [](const Mesh& mesh) { return mesh.mask != 0xffffffffu; }))
        counts.masks = meshes.size();
    require_memory(device, counts, config);
}

void require_memory(const Device& device, const TriangleBuffers& triangles, const Bvh::Config& config) {
    require(device, triangles.indices.size() / 3, config,
            [&](const Bvh::Config& with) { return plan_state(device, triangles, with); });
}

BvhMemory Bvh::memory_needed(const Device& device, std::size_t vertices, std::size_t triangles, const Config& config) {
    return plan_all(device, {.positions = 3 * vertices, .indices = 3 * triangles}, config);
}

}  // namespace claray
