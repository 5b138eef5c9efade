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

bool fits(const Device& device, const BvhMemory& memory) {
    return memory.bytes <= bytes_available(device) && gives_buffer(device, memory.largest_buffer);
}

using Plan = std::function<BvhMemory(const Bvh::Config&)>;

/// Configurations that take less memory, the best trees first.
std::vector<Bvh::Config> smaller_than(Bvh::Config config) {
    std::vector<Bvh::Config> smaller;
    if (!traits_of(config.builder).codes) config.builder = Builder::balanced, smaller.push_back(config);
    if (config.builder != Builder::fast) config.builder = Builder::fast, smaller.push_back(config);
    if (config.layout != Layout::binary) config.layout = Layout::binary, smaller.push_back(config);
    if (config.morton_bits != 30) config.morton_bits = 30, smaller.push_back(config);
    return smaller;
}

std::string difference(const Bvh::Config& from, const Bvh::Config& to) {
    std::vector<std::string> words;
    if (to.builder != from.builder) words.push_back(std::string("the builder ") + traits_of(to.builder).name);
    if (to.layout != from.layout) words.emplace_back("the binary layout");
    if (to.morton_bits != from.morton_bits) words.emplace_back("codes of 30 bits");
    std::string text = words.front();
    for (std::size_t i = 1; i < words.size(); ++i) text += (i + 1 == words.size() ? " and " : ", ") + words[i];
    return text;
}

/// Throws, and names the best configuration whose memory is accepted.
[[noreturn]] void refuse(const Device& device, const std::string& why, Bvh::Config config, const Plan& plan,
                         const std::function<bool(const BvhMemory&)>& accept) {
    config.builder = resolve(config.builder, device);
    for (const Bvh::Config& smaller : smaller_than(config)) {
        const BvhMemory memory = plan(smaller);
        if (accept(memory))
            throw Error(ErrorKind::device, why,
                        "choose " + difference(config, smaller) + ", with which it needs " + size_text(memory.bytes) +
                            ", or another device");
    }
    throw Error(ErrorKind::device, why, "use fewer triangles, or a device with more memory");
}

std::string needs(const Device& device, std::uint64_t triangles, const std::string& what) {
    return "out of device memory: a tree of " + std::to_string(triangles) + " triangles needs " + what + " on " +
           device.info().name;
}

void require(const Device& device, std::uint64_t triangles, const Bvh::Config& config, const Plan& plan) {
    const BvhMemory needed = plan(config);
    if (fits(device, needed)) return;
    const DeviceInfo& info = device.info();
    const std::uint64_t left = bytes_available(device);
    const std::string why = needed.bytes > left
                                ? needs(device, triangles, size_text(needed.bytes)) + ", which has " + size_text(left) +
                                      " of its " + size_text(info.memory) + " left"
                                : needs(device, triangles, "a buffer of " + size_text(needed.largest_buffer)) +
                                      ", which allocates at most " + size_text(info.max_allocation) + " per buffer";
    refuse(device, why, config, plan, [&](const BvhMemory& memory) { return fits(device, memory); });
}

}  // namespace

TriangleCounts counts_of(std::span<const Mesh> meshes) {
    TriangleCounts counts;
    for (const Mesh& mesh : meshes)
        counts.positions += 3 * mesh.positions.size(), counts.indices += 3 * mesh.triangles.size();
    if (meshes.size() > 1) counts.geometries = counts.indices / 3;
    if (std::any_of(meshes.begin(), meshes.end(), [](const Mesh& mesh) { return mesh.mask != 0xffffffffu; }))
        counts.masks = meshes.size();
    return counts;
}

TriangleCounts counts_of(const TriangleBuffers& triangles) {
    return {triangles.positions.size(), triangles.indices.size(), triangles.geometries.size(), triangles.masks.size()};
}

TriangleBuffers allocate_triangles(const Device& device, const TriangleCounts& counts) {
    TriangleBuffers triangles;
    triangles.positions = Buffer<float>(device, counts.positions);
    triangles.indices = Buffer<std::uint32_t>(device, counts.indices);
    if (counts.geometries > 0) triangles.geometries = Buffer<std::uint32_t>(device, counts.geometries);
    if (counts.masks > 0) triangles.masks = Buffer<std::uint32_t>(device, counts.masks);
    return triangles;
}

BvhMemory memory_needed(const Device& device, const TriangleCounts& counts, const Bvh::Config& config) {
    const MemoryPlan plan(device);
    const Bvh::State state(device, allocate_triangles(device, counts), config);
    return {plan.bytes(), plan.largest()};
}

void require_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config) {
    require(device, counts.indices / 3, config,
            [&](const Bvh::Config& with) { return memory_needed(device, counts, with); });
}

void require_memory(const Device& device, const TriangleBuffers& triangles, const Bvh::Config& config) {
    require(device, triangles.indices.size() / 3, config,
            [&](const Bvh::Config& with) { return plan_state(device, triangles, with); });
}

void commit_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config,
                   const std::function<void()>& allocate) try {
    const MemoryCommit commit(device);
    allocate();
} catch (const OutOfMemory&) {
    const Plan plan = [&](const Bvh::Config& with) { return memory_needed(device, counts, with); };
    const std::uint64_t bytes = plan(config).bytes;
    const std::string why = needs(device, counts.indices / 3, size_text(bytes)) + ", whose driver refuses some of it";
    // How much there is, is not known: the smaller half of the configurations may fit.
    refuse(device, why, config, plan, [&](const BvhMemory& memory) { return memory.bytes <= bytes / 2; });
}

BvhMemory Bvh::memory_needed(const Device& device, std::size_t vertices, std::size_t triangles, const Config& config) {
    return claray::memory_needed(device, {.positions = 3 * vertices, .indices = 3 * triangles}, config);
}

}  // namespace claray
