#include "host/trace/learning/better_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "host/bvh/bvh_state.hpp"

namespace claray {
TriangleBuffers triangles_held(const Device& queue, const Bvh& bvh) {
    const Bvh::State& state = bvh.state();
    BvhHeader header;
    detail::read(queue, state.header.memory(), 0, &header, sizeof header);
    std::vector<LeafTriangle> leaves(header.valid);
    if (!leaves.empty()) detail::read(queue, state.leaves.memory(), 0, leaves.data(), leaves.size() * sizeof leaves[0]);
    const std::size_t count = state.count, geometries = state.triangles.masks.size();
    std::vector<float> positions(9 * count, std::numeric_limits<float>::quiet_NaN());
    std::vector<std::uint32_t> of_triangles(count), masks(geometries), indices(3 * count);
    for (const LeafTriangle& leaf : leaves) {
        const float corners[] = {leaf.v0x, leaf.v0y, leaf.v0z, leaf.v1x, leaf.v1y,
                                 leaf.v1z, leaf.v2x, leaf.v2y, leaf.v2z};
        std::copy(std::begin(corners), std::end(corners), &positions[std::size_t(9) * leaf.primitive]);
        of_triangles[leaf.primitive] = leaf.geometry;
        if (geometries != 0) masks[leaf.geometry] = leaf.mask;
    }
    std::iota(indices.begin(), indices.end(), 0u);
    TriangleBuffers held;
    held.positions = Buffer<float>(queue, positions);
    held.indices = Buffer<std::uint32_t>(queue, indices);
    if (state.triangles.geometries.allocated()) held.geometries = Buffer<std::uint32_t>(queue, of_triangles);
    if (state.triangles.masks.allocated()) held.masks = Buffer<std::uint32_t>(queue, masks);
    return held;
}

double seconds_to_build_best(const Device& device, std::size_t triangles) {
    const double least = 1e-3 * device.tuning("trace/learning", "LEAST_MILLISECONDS");
    const unsigned picoseconds = device.tuning("plan/model", "HIGH_PICOSECONDS_PER_TRIANGLE");
    if (picoseconds == 0) return std::numeric_limits<double>::infinity();
    return std::max(least, double(triangles) * picoseconds * 1e-12);
}

Bvh build_best(const Device& queue, const Bvh& bvh, const TriangleBuffers& triangles) {
    Bvh::Config config = bvh.state().config;
    config.builder = Builder::high, config.layout = bvh.layout(), config.learns = false;
    const Bvh better = Bvh::build(queue, triangles, config);
    queue.finish();
    better.state().keep_tree_only();
    return better;
}

}  // namespace claray
