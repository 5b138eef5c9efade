#include "host/render/guiding/path_guide.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace claray {
namespace {

constexpr std::size_t map_side = CLARAY_GUIDE_SIDE, bins_of_map = CLARAY_GUIDE_BINS;
constexpr double uniform_share = 0.4;
constexpr double prior_paths = 2;           // of the map's mean light, which each bin counts in addition
constexpr std::uint64_t least_paths = 128;  // of a map that is not uniform
constexpr std::uint32_t all_numbers = 1u << 16;
constexpr std::uint32_t most_taught_pixels = 1u << 16;   // that teach, about
constexpr std::uint32_t least_guided_pixels = 1u << 14;  // of a smaller image there is too little to learn
constexpr std::size_t folds = CLARAY_GUIDE_FOLDS;
constexpr const char* stem = "render/path_guide";

KernelRequest learning(const char* name) {
    return {"render/guiding/learn_light.cl", name, {{"PATH_GUIDE", "1"}}};  // as shading
}

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
    for (std::size_t i = 0; i < map_side; ++i) {
        before += sizes[i];
        const std::uint32_t end =
            i + 1 < map_side ? std::uint32_t(std::lround(before / sum * all_numbers)) : all_numbers - 1;
        words[i / 2] = i % 2 == 0 ? end : words[i / 2] | end << 16;
    }
}

/// Their sizes in 1/65536.
std::array<std::uint32_t, map_side> read_sizes(const std::uint32_t* words) {
    std::array<std::uint32_t, map_side> sizes;
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < map_side; ++i) {
        const std::uint32_t end = i + 1 < map_side ? words[i / 2] >> (i % 2 * 16) & 0xffffu : all_numbers;
        sizes[i] = end - before, before = end;
    }
    return sizes;
}

void write_map(std::span<const GuideBin> bins, std::uint32_t* words) {
    const std::array<double, bins_of_map> density = densities_of(bins);
    std::array<double, map_side> columns{};
    for (std::size_t i = 0; i < bins_of_map; ++i) columns[i / map_side] += density[i];
    write_ends(columns, words);
    for (std::size_t c = 0; c < map_side; ++c)
        write_ends(std::span(density).subspan(c * map_side, map_side), words + map_side / 2 * (1 + c));
}

void add_bins(std::span<const GuideBin> bins, std::span<GuideBin> sum) {
    for (std::size_t i = 0; i < bins.size(); ++i)
        sum[i].squares += bins[i].squares, sum[i].effect += bins[i].effect, sum[i].paths += bins[i].paths,
            sum[i].longer += bins[i].longer;
}

using MapBins = std::array<GuideBin, bins_of_map>;

std::span<const GuideBin> bins_of(std::span<const GuideBin> found, std::size_t fold, std::size_t map) {
    return found.subspan(fold * found.size() / folds + map * bins_of_map, bins_of_map);
}

/// Of a map, the sum of all folds but one.
MapBins without_fold(std::span<const GuideBin> found, std::size_t fold, std::size_t map) {
    MapBins sum{};
    for (std::size_t k = 0; k < folds; ++k)
        if (k != fold) add_bins(bins_of(found, k, map), sum);
    return sum;
}

std::uint64_t paths_of(std::span<const GuideBin> bins) {
    std::uint64_t paths = 0;
    for (const GuideBin& bin : bins) paths += bin.paths;
    return paths;
}

}  // namespace

bool may_guide_paths(const Device& device, const RenderConfig& config) {
    const Approximations& approximate = config.approximate;
    const bool as_usual = !approximate.tile_sum && !approximate.light_grid && !approximate.flat &&
                          !approximate.gouraud && !approximate.no_shadows;
    return as_usual && device.info().type == DeviceType::cpu && device.tuning(stem, "LEAST_GAIN_PERCENT") != 0;
}

std::vector<std::uint32_t> guide_maps(std::span<const GuideBin> found) {
    const std::size_t maps = found.size() / folds / bins_of_map;
    std::vector<std::uint32_t> words(maps * CLARAY_GUIDE_WORDS);
    for (std::size_t map = 0; map < maps; ++map)
        write_map(without_fold(found, folds, map), &words[map * CLARAY_GUIDE_WORDS]);
    return words;
}

std::vector<std::uint64_t> shares_of_bins(std::span<const std::uint32_t> map) {
    std::vector<std::uint64_t> shares;
    const std::array<std::uint32_t, map_side> columns = read_sizes(map.data());
    for (std::size_t c = 0; c < map_side; ++c)
        for (const std::uint32_t row : read_sizes(map.data() + map_side / 2 * (1 + c)))
            shares.push_back(std::uint64_t(columns[c]) * row);
    return shares;
}

GuideTrial try_guiding(std::span<const GuideBin> found) {
    GuideTrial trial;
    std::array<std::uint32_t, CLARAY_GUIDE_WORDS> words;
    for (std::size_t map = 0; map < found.size() / folds / bins_of_map; ++map) {
        std::uint64_t paths = 0;
        for (std::size_t fold = 0; fold < folds; ++fold) paths += paths_of(bins_of(found, fold, map));
        if (paths < least_paths) continue;
        double without = 0, with = 0;
        for (std::size_t fold = 0; fold < folds; ++fold) {
            write_map(without_fold(found, fold, map), words.data());
            const std::vector<std::uint64_t> shares = shares_of_bins(words);
            const std::span<const GuideBin> bins = bins_of(found, fold, map);
            for (std::size_t i = 0; i < bins_of_map; ++i) {
                const double density = double(shares[i]) * double(bins_of_map) / (double(all_numbers) * all_numbers);
                without += double(bins[i].effect);
                with += double(bins[i].effect) / density;
                trial.longer += bins[i].longer, trial.longer_with += bins[i].longer * density;
            }
        }
        trial.without += without, trial.with += with;
        trial.variance += (without - with) * (without - with);
    }
    return trial;
}

bool PathGuide::is_for(const RenderConfig& config) {
    return config.guide && config.width * config.height >= least_guided_pixels;
}

PathGuide::PathGuide(const Device& device, const Bounds& scene, std::uint32_t pixels)
    : device_(device), pixels_(pixels), every_((pixels + most_taught_pixels - 1) / most_taught_pixels) {
    const glm::vec3 extent = glm::max(scene.extent(), glm::vec3(1e-30f));
    data_.x = scene.lo.x, data_.y = scene.lo.y, data_.z = scene.lo.z;
    data_.scale_x = CLARAY_GUIDE_CELLS / extent.x, data_.scale_y = CLARAY_GUIDE_CELLS / extent.y;
    data_.scale_z = CLARAY_GUIDE_CELLS / extent.z;
}

/// Both kernels are in one program.
KernelSet PathGuide::programs(const Device& device) {
    KernelSet set;
    set.add(device, learning("learn_light"));
    return set;
}

PathGuide::Phase PathGuide::phase_at(std::uint32_t sample) {
    return Phase(std::upper_bound(ends.begin(), ends.end(), sample) - ends.begin());
}

/// Batches of rounds of adaptive sampling number entries of a list; these have their first 16 samples.
PathGuide::Phase PathGuide::phase_of(const Batch& batch) {
    return batch.listed ? last_phase : phase_at(batch.first_sample);
}

/// The first two phases teach the maps for samples from `unguided_spp` on.
bool PathGuide::pays_to_teach(Phase phase, unsigned spp) {
    return phase != last_phase && spp > ends[std::max(phase, unguided_phase)];
}

void PathGuide::trace(Batch batch, unsigned spp, Wavefront& wavefront, const std::function<void(const Batch&)>& add) {
    while (batch.samples > 0) {
        Batch part = batch;
        if (!batch.listed) part.samples = std::min(batch.samples, ends[phase_of(batch)] - batch.first_sample);
        trace_part(part, spp, wavefront);
        add(part);
        batch.first_sample += part.samples, batch.samples -= part.samples;
    }
}

void PathGuide::trace_beside(Batch batch, Wavefront& wavefront, const std::function<void(const Batch&)>& add) {
    while (batch.samples > 0) {
        Batch part = batch;
        const Phase phase = phase_at(batch.first_sample);
        part.samples = std::min(batch.samples, ends[phase] - batch.first_sample);
        wavefront.frame.guide = data_for(std::min(phase, phase_), false, wavefront.scene);
        wavefront.trace(part);
        wavefront.frame.guide = {};
        add(part);
        batch.first_sample += part.samples, batch.samples -= part.samples;
    }
}

void PathGuide::trace_region(Batch batch, Wavefront& wavefront, const std::function<void(const Batch&)>& add) {
    while (batch.samples > 0) {
        const Phase phase = phase_at(batch.first_sample);
        if (phase >= first_phase && phase > phase_) learn_until(phase, wavefront);
        Batch part = batch;
        part.samples = std::min(batch.samples, ends[phase] - batch.first_sample);
        trace_beside(part, wavefront, add);
        batch.first_sample += part.samples, batch.samples -= part.samples;
    }
}

/// What other rays do meanwhile is not guided.
void PathGuide::trace_part(const Batch& part, unsigned spp, Wavefront& wavefront) {
    const Phase phase = phase_of(part);
    if (phase >= first_phase && phase > phase_) learn_until(phase, wavefront);
    const bool teaches = phase == phase_ && pays_to_teach(phase, spp) && follows(part);
    wavefront.frame.guide = data_for(phase, teaches, wavefront.scene);
    wavefront.trace(part);
    if (teaches) learn(part, wavefront), advance(part);
    wavefront.frame.guide = {};
}

bool PathGuide::follows(const Batch& part) const {
    const std::uint32_t pass = cursor_.pixel == 0 ? part.samples : cursor_.pass;
    return part.first_pixel == cursor_.pixel && part.first_sample == cursor_.sample && part.samples == pass;
}

void PathGuide::advance(const Batch& part) {
    cursor_.pass = part.samples, cursor_.pixel += part.pixels;
    if (cursor_.pixel < pixels_) return;
    cursor_.pixel = 0, cursor_.sample += cursor_.pass;
    if (cursor_.sample == ends[phase_]) end_phase();
}

void PathGuide::learn(const Batch& part, const Wavefront& wavefront) {
    const Step step = wavefront.step_of(part, 0, 0);
    const Range size{std::size_t(part.pixels) * part.samples, 64};
    if (counts_.size() == 0) {
        counts_ = Buffer<std::uint32_t>(device_, std::vector<std::uint32_t>(CLARAY_GUIDE_EXPONENTS));
    }
    if (phase_ == unit_phase)
        load_kernel(device_, learning("count_exponents")).run(size, step, every_, wavefront.queues.radiance, counts_);
    else
        load_kernel(device_, learning("learn_light")).run(size, step, every_, wavefront.queues.radiance, found_);
}

/// From samples that are not added to an image.
void PathGuide::learn_until(Phase phase, Wavefront& wavefront) {
    if (cursor_.pixel != 0 || cursor_.sample != first_sample()) forget();
    while (phase_ < phase) {
        trace_runs(first_sample(), ends[phase_] - first_sample(), wavefront);
        end_phase();
    }
    cursor_.sample = first_sample();
}

std::uint32_t PathGuide::first_sample() const { return phase_ == unit_phase ? 0 : ends[phase_ - 1]; }

void PathGuide::trace_runs(std::uint32_t first_sample, std::uint32_t samples, Wavefront& wavefront) {
    const std::uint32_t at_once = std::min(samples, wavefront.queues.capacity);
    const std::uint32_t run = every_ == 1 ? pixels_ : CLARAY_GUIDE_RUN;
    wavefront.frame.guide = data_for(phase_, true, wavefront.scene);
    for (std::uint32_t pixel = 0; pixel < pixels_;) {
        if (pixel / CLARAY_GUIDE_RUN % every_ != 0) {
            pixel += CLARAY_GUIDE_RUN;
            continue;
        }
        const std::uint32_t left = std::min(run - pixel % run, pixels_ - pixel);
        const std::uint32_t pixels = std::min(left, wavefront.queues.capacity / at_once);
        for (std::uint32_t done = 0; done < samples; done += at_once) {
            const Batch batch{pixel, pixels, first_sample + done, std::min(at_once, samples - done), 0};
            wavefront.trace(batch);
            learn(batch, wavefront);
        }
        pixel += pixels;
    }
    wavefront.frame.guide = {};
}

void PathGuide::forget() {
    phase_ = unit_phase, on_device_ = unit_phase;
    cursor_ = {};
    maps_ = {};
    if (counts_.size() > 0) counts_.fill(0);
}

bool PathGuide::pays(std::span<const GuideBin> found) const {
    return 100 * try_guiding(found).promise() >= device_.tuning(stem, "LEAST_GAIN_PERCENT");
}

/// Blocks.
void PathGuide::end_phase() {
    const Phase next = Phase(phase_ + 1);
    if (phase_ == unit_phase) {
        phase_ = tell_unit() ? next : last_phase;
        return;
    }
    found_.view([&](std::span<const GuideBin> found) {
        if (phase_ == first_phase || pays(found))
            maps_[next] = guide_maps(found), phase_ = next;
        else
            phase_ = last_phase;
    });
}

/// A power of two, so that it does not depend on the last bits of the mean.
bool PathGuide::tell_unit() {
    const std::vector<std::uint32_t> counts = counts_.read();
    double sum = 0, paths = 0;
    for (std::size_t e = 0; e < counts.size(); ++e)
        sum += e > 0 ? counts[e] * std::exp2(double(e) - 127) : 0, paths += counts[e];
    if (!(sum > 0)) return false;
    data_.unit = float(std::exp2(-std::round(std::log2(1.5 * sum / paths))));
    if (found_.size() == 0) found_ = Buffer<GuideBin>(device_, folds * CLARAY_GUIDE_MAPS * bins_of_map);
    found_.fill(0);
    return true;
}

PathGuideData PathGuide::data_for(Phase phase, bool teaches, SceneBuffers& scene) {
    PathGuideData data = data_;
    data.lessons = teaches && phase != unit_phase ? floats_of_paths(scene.where) : 0;
    data.guides = maps_[phase].empty() ? 0 : 1;
    if (data.guides != 0 && on_device_ != phase)
        scene.tables.write(maps_[phase], scene.where.guide), on_device_ = phase;
    return data;
}

}  // namespace claray
