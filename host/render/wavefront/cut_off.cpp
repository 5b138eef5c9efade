#include "host/render/wavefront/cut_off.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace claray {
namespace {

/// Results of paths that continue beyond a limit of depth.
struct Carried {
    double dropped = 0, left = 0;   // throughput at that limit, and at the end
    double within = 0, beyond = 0;  // light that is found before the limit, and after it
};

/// Sum of the throughput of rays of this depth, without rays aimed at hot spots.
double carried_on(Queues& queues, std::uint32_t depth, std::uint32_t rays) {
    double sum = 0;
    std::vector<PathState> states(rays);
    queues.of_depth(depth).states.read(std::span(states));
    for (const PathState& state : states)
        if ((state.flags & CLARAY_TO_HOT_SPOT) == 0)
            sum += double(state.throughput_r) + state.throughput_g + state.throughput_b;
    return sum;
}

double light_of(const Queues& queues, std::uint32_t paths) {
    double sum = 0;
    std::vector<float> values(3 * std::size_t(paths));
    queues.radiance.read(std::span(values));
    for (const float value : values)
        if (std::isfinite(value)) sum += value;
    return sum;
}

void follow(Wavefront& wavefront, const Batch& batch, std::uint32_t limit_of_depth, Carried& sums) {
    Queues& queues = wavefront.queues;
    const std::uint32_t paths = batch.pixels * batch.samples;
    wavefront.make_room(paths);
    wavefront.generate(batch, false);
    const std::uint32_t waves = wavefront.step_of(batch, 0, paths).waves;
    std::optional<double> within;
    std::uint32_t limit = paths;
    for (std::uint32_t depth = 0; depth < waves && limit != 0; ++depth) {
        wavefront.scatter(batch, depth, limit, false, true);
        if (depth == limit_of_depth) within = light_of(queues, paths);  // with the emission of the last surface
        wavefront.look_for_light(depth, limit);
        limit = queues.lengths.of_rays(depth + 1).read()[0];
        if (depth + 1 == limit_of_depth) sums.dropped += carried_on(queues, depth + 1, limit);
        if (depth + 1 == wavefront.frame.max_depth) sums.left += carried_on(queues, depth + 1, limit);
    }
    wavefront.empty_queues();
    const double all = light_of(queues, paths);
    sums.within += within.value_or(all), sums.beyond += all - within.value_or(all);
}

}  // namespace

/// Traces paths of a small image to twice the depth. The light found beyond the limit is missing, and so is the light
/// of the remaining throughput, which is assumed to carry as much light per throughput as at the limit: missing =
/// beyond + missing * left / dropped. This is exact if light falls by the same factor at each bounce.
double share_cut_off(const Wavefront& wavefront) {
    if (wavefront.kernels.tile_sum) return 0;  // which answers for the first surface only
    constexpr std::uint32_t most_side = 128, paths = most_side * most_side;
    constexpr double slowest_fall = 0.99;  // the estimate is at most 100 times the light found
    constexpr double least_share = 1e-5;   // smallest share that so few paths can resolve
    FrameData frame = wavefront.frame;     // the same view in fewer pixels
    const std::uint32_t limit_of_depth = frame.max_depth;
    frame.width = std::min(frame.width, most_side), frame.height = std::min(frame.height, most_side);
    frame.seed = ~frame.seed;
    frame.max_depth = std::max(limit_of_depth, 2 * std::min(limit_of_depth, 1u << 30));
    const std::uint32_t pixels = frame.width * frame.height;
    Wavefront probe(wavefront.scene, frame, wavefront.kernels, paths);
    probe.queues.layer_table = wavefront.queues.layer_table;  // which its kernels read
    const std::uint32_t capacity = probe.queues.capacity;
    const std::uint32_t at_once = std::min(capacity, pixels), samples = std::max(1u, capacity / pixels);
    Carried sums;
    for (std::uint32_t first = 0; first < pixels; first += at_once)
        follow(probe, {first, std::min(at_once, pixels - first), 0, samples, 0}, limit_of_depth, sums);
    if (!(sums.beyond > 0)) return 0;
    const double missing = sums.beyond / (1 - std::min(sums.left / sums.dropped, slowest_fall));
    const double share = missing / (sums.within + missing);
    return share < least_share ? 0 : share;
}

}  // namespace claray
