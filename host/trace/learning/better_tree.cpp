#include "host/trace/learning/better_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "host/bvh/bvh_state.hpp"
#include "host/trace/query_kernel.hpp"

namespace claray {
namespace {

/// The sample's kernels for one tree.
class SampleQueries {
public:
    SampleQueries(const Device& queue, const Bvh& bvh, const std::vector<RaySample::Piece>& sample)
        : queue_(queue), sample_(sample) {
        for (const RaySample::Piece& piece : sample) {
            queries_.emplace_back(queue, bvh, piece.kind, piece.options);
            rays_ += piece.stands_for;
        }
    }

    /// Of all rays that the sample stands for, by the device's clock.
    double seconds_per_ray() {
        double seconds = 0;
        for (std::size_t i = 0; i < sample_.size(); ++i) {
            queue_.profiler().reset();
            run(queries_[i], sample_[i]);
            const double rays = double(sample_[i].rays.size());
            seconds += queue_.profiler().total_milliseconds() * 1e-3 * sample_[i].stands_for / rays;
        }
        return seconds / rays_;
    }

private:
    void run(QueryKernel& query, const RaySample::Piece& piece) {
        const auto count = std::uint32_t(piece.rays.size());
        if (piece.kind == QueryKind::closest) {
            hits_.reserve(queue_, count);
            query.run(piece.rays, hits_, count);
        } else {
            occluded_.reserve(queue_, count);
            query.run(piece.rays, occluded_, count);
        }
    }

    const Device& queue_;
    const std::vector<RaySample::Piece>& sample_;
    std::vector<QueryKernel> queries_;
    Buffer<Hit> hits_;
    Buffer<std::uint8_t> occluded_;
    double rays_ = 0;
};

}  // namespace

double seconds_per_ray(const Device& queue, const Bvh& bvh, const std::vector<RaySample::Piece>& sample) {
    SampleQueries queries(queue, bvh, sample);
    static_cast<void>(queries.seconds_per_ray());  // warms the caches up, and compiles
    return queries.seconds_per_ray();
}

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

bool is_faster(const Device& queue, const Bvh& bvh, const Bvh& other, const std::vector<RaySample::Piece>& sample,
               const std::function<bool()>& stop) {
    constexpr int turns = 5;
    constexpr double least_gain = 0.97;  // a smaller one is not worth the memory
    SampleQueries before(queue, bvh, sample), after(queue, other, sample);
    std::vector<double> ratios;
    for (int turn = -1; turn < turns; ++turn) {  // the first warms the caches up
        if (stop()) return false;
        const double ratio = after.seconds_per_ray() / before.seconds_per_ray();
        if (turn >= 0) ratios.push_back(ratio);
    }
    std::nth_element(ratios.begin(), ratios.begin() + turns / 2, ratios.end());
    return ratios[turns / 2] < least_gain;
}

}  // namespace claray
