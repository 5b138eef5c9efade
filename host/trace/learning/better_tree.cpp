#include "host/trace/learning/better_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "host/bvh/bvh_state.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/memory.hpp"

namespace claray {
namespace {

/// Vertices are not shared, and those of culled triangles are NaN.
TriangleBuffers upload(const Device& queue, HeldTriangles held) {
    std::vector<float> positions(9 * held.count, std::numeric_limits<float>::quiet_NaN());
    std::vector<std::uint32_t> geometries(held.has_geometries ? held.count : 0), masks(held.geometries);
    for (const LeafTriangle& leaf : held.leaves) {
        const float corners[] = {leaf.v0x, leaf.v0y, leaf.v0z, leaf.v1x, leaf.v1y,
                                 leaf.v1z, leaf.v2x, leaf.v2y, leaf.v2z};
        std::copy(std::begin(corners), std::end(corners), &positions[std::size_t(9) * leaf.primitive]);
        if (!geometries.empty()) geometries[leaf.primitive] = leaf.geometry;
        if (!masks.empty()) masks[leaf.geometry] = leaf.mask;
    }
    std::vector<std::uint32_t> indices(3 * held.count);
    std::iota(indices.begin(), indices.end(), 0u);
    TriangleBuffers buffers;
    buffers.positions = Buffer<float>(queue, positions);
    buffers.indices = Buffer<std::uint32_t>(queue, indices);
    if (!geometries.empty()) buffers.geometries = Buffer<std::uint32_t>(queue, geometries);
    if (!masks.empty()) buffers.masks = Buffer<std::uint32_t>(queue, masks);
    return buffers;
}

/// Frees the elements behind the first `count`.
template <class T>
void shorten(const Device& queue, Buffer<T>& buffer, std::size_t count) {
    if (count >= buffer.size()) return;
    const Buffer<T> shorter(queue, count);
    if (count != 0) detail::copy(queue, buffer.memory(), shorter.memory(), shorter.bytes());
    buffer = shorter;
}

/// Frees all that a traversal does not read.
void keep_what_is_traced(const Device& queue, Bvh::State& state) {
    const BvhHeader header = state.read_header();
    state.keep_tree_only();
    shorten(queue, state.nodes, header.inner_nodes);
    shorten(queue, state.leaves, header.valid);
    shorten(queue, state.wide_nodes, header.wide_nodes);
    shorten(queue, state.wide_blocks, header.wide_blocks);
    queue.finish();
}

}  // namespace

HeldTriangles read_triangles(const Device& queue, const Bvh& bvh) {
    const Bvh::State& state = state_of(bvh);
    BvhHeader header;
    detail::read(queue, state.header.memory(), 0, &header, sizeof header);
    HeldTriangles held;
    held.leaves.resize(header.valid);
    if (header.valid != 0)
        detail::read(queue, state.leaves.memory(), 0, held.leaves.data(), header.valid * sizeof(LeafTriangle));
    held.count = state.count;
    held.geometries = state.triangles.masks.size();
    held.has_geometries = state.triangles.geometries.allocated();
    return held;
}

double seconds_to_build_best(const Device& device, std::size_t triangles) {
    constexpr double picoseconds_unknown = 1e6;
    const auto& tuning = state_of(device).tuning;
    const auto row = tuning.find("plan/model HIGH_PICOSECONDS_PER_TRIANGLE");
    const double picoseconds = row == tuning.end() || row->second == 0 ? picoseconds_unknown : row->second;
    const double least = 1e-3 * device.tuning("trace/learning", "LEAST_MILLISECONDS");
    return std::max(least, double(triangles) * picoseconds * 1e-12);
}

Bvh build_best(const Device& queue, HeldTriangles triangles, Bvh::Config config) {
    config.builder = Builder::high, config.learns = false;
    const BvhMemory needed = Bvh::memory_needed(queue, 3 * triangles.count, triangles.count, config);
    if (needed.bytes > bytes_available(queue) / 2)
        throw Error(ErrorKind::device, "a better tree would need " + size_text(needed.bytes) +
                                           ", more than half of the memory that is left");
    Bvh better = Bvh::build(queue, upload(queue, std::move(triangles)), config);
    keep_what_is_traced(queue, state_of(better));
    return better;
}

}  // namespace claray
