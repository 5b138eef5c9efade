#include "host/render/guiding/path_guide.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace claray {
namespace {

constexpr std::size_t side = CLARAY_GUIDE_SIDE, bins_of_map = CLARAY_GUIDE_BINS;
constexpr double uniform_share = 0.4;
constexpr double prior_paths = 2;           // of the map's mean light, which each bin counts in addition
constexpr std::uint64_t least_paths = 128;  // of a map that is not uniform
constexpr std::uint32_t all = 1u << 16;
constexpr unsigned samples_to_decide = 8, samples_to_learn = 16;  // per pixel
constexpr const char* stem = "render/path_guide";

Kernel learning(const Device& device) { return load_kernel(device, "render/guiding/learn_light.cl", "learn_light"); }

/// Probabilities of a map's bins.
std::array<double, bins_of_map> densities_of(std::span<const GuideBin> bins) {
    std::array<double, bins_of_map> density;
    density.fill(1.0 / double(bins_of_map));
    double paths = 0, squares = 0, sum = 0;
    for (const GuideBin& bin : bins) paths += bin.paths, squares += double(bin.squares);
    if (paths < double(least_paths) || !(squares > 0)) return density;
    std::array<double, bins_of_map> root;
    for (std::size_t i = 0; i < bins_of_map; ++i) {
        root[i] = std::sqrt((double(bins[i].squares) + prior_paths * squares / paths) / (bins[i].paths + prior_paths));
        sum += root[i];
    }
    for (std::size_t i = 0; i < bins_of_map; ++i)
        density[i] = uniform_share * density[i] + (1 - uniform_share) * root[i] / sum;
    return density;
}

/// The ends of eight intervals of these sizes, in 16 bits each.
void write_ends(std::span<const double> sizes, std::uint32_t* words) {
    double sum = 0, before = 0;
    for (const double size : sizes) sum += size;
    for (std::size_t i = 0; i < side; ++i) {
        before += sizes[i];
        const std::uint32_t end = i + 1 < side ? std::uint32_t(std::lround(before / sum * all)) : all - 1;
        words[i / 2] = i % 2 == 0 ? end : words[i / 2] | end << 16;
    }
}

/// Their sizes in 1/65536.
std::array<std::uint32_t, side> read_sizes(const std::uint32_t* words) {
    std::array<std::uint32_t, side> sizes;
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < side; ++i) {
        const std::uint32_t end = i + 1 < side ? words[i / 2] >> (i % 2 * 16) & 0xffffu : all;
        sizes[i] = end - before, before = end;
    }
    return sizes;
}

void write_map(std::span<const GuideBin> bins, std::uint32_t* words) {
    const std::array<double, bins_of_map> density = densities_of(bins);
    std::array<double, side> columns{};
    for (std::size_t i = 0; i < bins_of_map; ++i) columns[i / side] += density[i];
    write_ends(columns, words);
    for (std::size_t c = 0; c < side; ++c)
        write_ends(std::span(density).subspan(c * side, side), words + side / 2 * (1 + c));
}

}  // namespace

bool may_guide_paths(const Device& device, const RenderConfig& config) {
    const Approximations& approximate = config.approximate;
    const bool as_usual = !approximate.tile_sum && !approximate.light_grid && !approximate.flat &&
                          !approximate.gouraud && !approximate.no_shadows;
    return config.guide && as_usual && device.info().type == DeviceType::cpu &&
           device.tuning(stem, "LEAST_GAIN_PERCENT") != 0;
}

std::vector<std::uint32_t> guide_maps(std::span<const GuideBin> bins) {
    std::vector<std::uint32_t> words(bins.size() / bins_of_map * CLARAY_GUIDE_WORDS);
    for (std::size_t map = 0; map < bins.size() / bins_of_map; ++map)
        write_map(bins.subspan(map * bins_of_map, bins_of_map), &words[map * CLARAY_GUIDE_WORDS]);
    return words;
}

std::vector<std::uint64_t> shares_of_bins(std::span<const std::uint32_t> map) {
    std::vector<std::uint64_t> shares;
    const std::array<std::uint32_t, side> columns = read_sizes(map.data());
    for (std::size_t c = 0; c < side; ++c)
        for (const std::uint32_t row : read_sizes(map.data() + side / 2 * (1 + c)))
            shares.push_back(std::uint64_t(columns[c]) * row);
    return shares;
}

double gain_of(std::span<const std::uint32_t> maps, std::span<const GuideBin> bins) {
    double without = 0, with = 0;
    for (std::size_t map = 0; map < bins.size() / bins_of_map; ++map) {
        const std::span<const GuideBin> of = bins.subspan(map * bins_of_map, bins_of_map);
        const std::vector<std::uint64_t> shares =
            shares_of_bins(maps.subspan(map * CLARAY_GUIDE_WORDS, CLARAY_GUIDE_WORDS));
        for (std::size_t i = 0; i < bins_of_map; ++i) {
            without += double(of[i].squares);
            with += double(of[i].squares) * (double(all) * all / double(bins_of_map)) / double(shares[i]);
        }
    }
    return with > 0 ? without / with : 1;
}

PathGuide::PathGuide(const Device& device, const Bounds& scene) : device_(device) {
    const glm::vec3 extent = glm::max(scene.extent(), glm::vec3(1e-30f));
    data_.x = scene.lo.x, data_.y = scene.lo.y, data_.z = scene.lo.z;
    data_.scale_x = CLARAY_GUIDE_CELLS / extent.x, data_.scale_y = CLARAY_GUIDE_CELLS / extent.y;
    data_.scale_z = CLARAY_GUIDE_CELLS / extent.z;
}

void PathGuide::load_kernels(const Device& device) { (void)learning(device); }

/// The unit is a power of two, so that it does not depend on the last bits of the mean.
void PathGuide::begin(std::uint32_t floats_of_paths, double mean) {
    if (!(mean > 0) || !std::isfinite(mean)) return;
    data_.unit = float(std::exp2(-std::round(std::log2(mean))));
    data_.lessons = floats_of_paths;
    sum_.assign(std::size_t(CLARAY_GUIDE_MAPS) * bins_of_map, {});
    found_ = Buffer<GuideBin>(device_, sum_);
    learn_ = learning(device_);
}

void PathGuide::learn(const Step& step, const Buffer<float>& radiance) {
    if (data_.lessons == 0) return;
    learn_.run({std::size_t(step.batch.pixels) * step.batch.samples, 64}, step, radiance, found_);
}

/// Maps of few paths promise less than those that guide in the end.
bool PathGuide::promises_gain(std::span<const GuideBin> found) const {
    return 100 * gain_of(guide_maps(sum_), found) >= device_.tuning(stem, "LEAST_GAIN_PERCENT");
}

void PathGuide::learned(unsigned samples, SceneBuffers& scene) {
    const std::vector<GuideBin> found = found_.read();
    if (samples >= samples_to_decide && data_.guides == 0 && !promises_gain(found)) data_.lessons = 0;
    if (data_.lessons == 0) return;
    for (std::size_t i = 0; i < found.size(); ++i) sum_[i].squares += found[i].squares, sum_[i].paths += found[i].paths;
    found_.fill(0);
    if (samples < samples_to_decide) return;
    scene.tables.write(guide_maps(sum_), scene.where.guide);
    data_.guides = 1;
    if (samples >= samples_to_learn) data_.lessons = 0;
}

}  // namespace claray
