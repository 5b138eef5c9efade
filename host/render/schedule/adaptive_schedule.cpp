#include "host/render/schedule/adaptive_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace claray {
namespace {

constexpr std::uint32_t tile_side = CLARAY_TILE_SIDE;
constexpr std::uint32_t first_samples = 16;  // per pixel, of the whole image: fewer tell little about the error
constexpr std::uint64_t parts_per_round = 4;
/// Every half of a tile has at least this share of the mean number of samples, so that light which its first samples
/// missed is found in the end.
constexpr std::uint64_t least_share = 8;
constexpr std::uint32_t most_samples = 1u << 30;
constexpr std::size_t halves_per_left_out = 100;

std::uint32_t tiles_along(std::uint32_t side) { return (side + tile_side - 1) / tile_side; }

/// The other half of a tile.
std::uint32_t partner(std::uint32_t half) { return half ^ 1; }

}  // namespace

AdaptiveSchedule::AdaptiveSchedule(std::uint32_t width, std::uint32_t height, std::uint32_t spp,
                                   std::uint32_t paths_in_flight, bool adaptive, double least_gain)
    : width_(width),
      height_(height),
      columns_(tiles_along(width)),
      rows_(tiles_along(height)),
      spp_(spp),
      paths_(paths_in_flight),
      budget_(std::uint64_t(width) * height * spp),
      adaptive_(adaptive && spp > first_samples),
      least_gain_(least_gain),
      uniform_(width * height, adaptive_ ? first_samples : spp, paths_in_flight) {}

std::uint32_t AdaptiveSchedule::pixels_of(std::uint32_t half) const {
    const std::uint32_t tile = half / 2, x = tile % columns_ * tile_side, y = tile / columns_ * tile_side;
    return (std::min(tile_side, width_ - x) * std::min(tile_side, height_ - y) + 1 - half % 2) / 2;
}

/// For each half tile its variance as other pixels tell it. The other half of the tile may have missed what makes the
/// noise; the mean of all other halves of the 3x3 tiles around is a lower limit.
std::vector<double> AdaptiveSchedule::estimate_from_other_halves(const std::vector<float>& variances) const {
    std::vector<double> rows(variances.size() / 2), result(variances.size());  // sums of three tiles side by side
    for (std::uint32_t t = 0; t < rows.size(); ++t) {
        const std::uint32_t x = t % columns_, left = x > 0, right = x + 1 < columns_;
        for (std::uint32_t h = 2 * (t - left); h < 2 * (t + right + 1); ++h) rows[t] += double(variances[h]);
    }
    for (std::uint32_t h = 0; h < variances.size(); ++h) {
        const std::uint32_t t = h / 2, x = t % columns_, y = t / columns_, above = y > 0, below = y + 1 < rows_;
        double sum = rows[t] - double(variances[h]);
        if (above) sum += rows[t - columns_];
        if (below) sum += rows[t + columns_];
        const std::uint32_t tiles = (1 + (x > 0) + (x + 1 < columns_)) * (1 + above + below);
        result[h] = std::max(double(variances[partner(h)]), sum / (2 * tiles - 1));
    }
    return result;
}

/// If the squared error of n samples falls like 1/n, the best numbers of samples are proportional to the square roots.
/// Leaves out the halves of tiles with the largest variances: those that have most of the error alone, such as the edge
/// of a lamp, converge faster, or have met a firefly.
double AdaptiveSchedule::gain(const std::vector<float>& variances) const {
    const std::size_t left_out = variances.size() / halves_per_left_out;
    std::vector<float> largest = variances;
    std::nth_element(largest.begin(), largest.begin() + std::ptrdiff_t(left_out), largest.end(), std::greater());
    double squares = 0, roots = 0, all = 0;
    for (std::uint32_t h = 0; h < variances.size(); ++h) {
        if (variances[h] > largest[left_out]) continue;
        squares += double(variances[h]) * pixels_of(h), all += pixels_of(h);
        roots += std::sqrt(double(variances[h])) * pixels_of(h);
    }
    return roots > 0 ? squares * all / (roots * roots) : 1;
}

/// Marks the half tiles of the next round, by the variances of one sample. The squared error of n samples falls like
/// 1/n or faster, so that doubling them gains about half of it, for n samples more.
void AdaptiveSchedule::choose(const std::vector<double>& variances) {
    std::vector<std::pair<double, std::uint32_t>> heap;  // the first of equal ones has the largest second number
    for (std::uint32_t h = 0; h < halves_.size(); ++h) {
        if (pixels_of(h) == 0 || halves_[h] >= most_samples) continue;
        const double samples = halves_[h];
        const bool lags = samples * double(least_share * pixels()) < double(done_);
        const double gain = variances[h] / (samples * samples);
        heap.emplace_back(lags ? std::numeric_limits<double>::infinity() : gain, ~h);
    }
    std::make_heap(heap.begin(), heap.end());
    const std::uint64_t left = budget_ - done_, wanted = std::min(left, done_ / parts_per_round);
    const std::uint32_t unit = least_samples();
    std::uint64_t taken = 0, room = words_per_pixel / 2 * pixels();
    for (; !heap.empty() && taken < wanted; heap.pop_back()) {
        std::pop_heap(heap.begin(), heap.end());
        const std::uint32_t half = ~heap.back().second;
        const std::uint64_t cost = std::uint64_t(halves_[half]) * pixels_of(half);
        if (taken + cost > left || cost / unit > room) continue;
        taken += cost, room -= cost / unit;
        halves_[half] |= chosen;
    }
}

void AdaptiveSchedule::plan(const std::vector<float>& variances) {
    const std::uint32_t so_far = uniform_.complete_passes_spp();
    if (halves_.empty() && gain(variances) < least_gain_) return uniform_.extend(next_plan(so_far + 1));
    if (halves_.empty()) {
        halves_.assign(2 * std::size_t(columns_) * rows_, so_far);
        done_ = pixels() * so_far;
    }
    std::vector<float> of_one_sample = variances;
    for (std::uint32_t h = 0; h < halves_.size(); ++h) of_one_sample[h] *= float(halves_[h]);
    choose(estimate_from_other_halves(of_one_sample));
    list_chosen();
    has_ended_ = !in_round();
}

std::uint32_t AdaptiveSchedule::next_plan(std::uint32_t samples) const {
    std::uint32_t at = first_samples;
    while (at < samples && at < spp_) at *= 2;
    return std::min(at, spp_);
}

std::uint32_t AdaptiveSchedule::least_samples() const {
    std::uint32_t least = most_samples;
    for (std::uint32_t h = 0; h < halves_.size(); ++h)
        if (pixels_of(h) > 0) least = std::min(least, halves_[h] & ~chosen);
    return least;
}

bool AdaptiveSchedule::none_fits() const {
    return budget_ - done_ < std::uint64_t(least_samples()) * tile_side * tile_side;
}

void AdaptiveSchedule::list_chosen() {
    const std::uint32_t unit = least_samples();
    round_ = {};
    entry_ = sample_ = 0;
    for (std::uint32_t h = 0; h < halves_.size(); ++h) {
        if (!(halves_[h] & chosen)) continue;
        const std::uint32_t samples = halves_[h] & ~chosen;
        for (const std::uint32_t word : {h, samples, round_.entries}) round_.halves.push_back(word);
        round_.unit = unit, round_.entries += samples / unit * pixels_of(h);
    }
}

void AdaptiveSchedule::end_round() {
    done_ = samples();
    for (std::uint32_t& samples : halves_)
        if (samples & chosen) samples = 2 * (samples & ~chosen);
    has_ended_ = none_fits();
    round_ = {};
    entry_ = sample_ = 0;
}

/// Each entry's samples are complete before the next entry begins, so that each pixel gets its samples in their order.
Batch AdaptiveSchedule::next(std::uint32_t most_paths) {
    const std::uint32_t most = std::max(1u, std::min(most_paths, paths_)), unit = round_.unit;
    if (!pending_.empty()) return pending_.next(most);
    if (!in_round()) return uniform_.next(most);
    Batch batch{entry_, 1, sample_, std::min(unit - sample_, most), 1};
    if (batch.samples < unit) {  // a part of one entry
        sample_ += batch.samples;
        if (sample_ == unit) sample_ = 0, ++entry_;
    } else {
        batch.pixels = std::min(most / unit, round_.entries - entry_);
        entry_ += batch.pixels;
    }
    if (entry_ == round_.entries) end_round();
    return batch;
}

std::uint32_t AdaptiveSchedule::complete_passes_spp() const {
    if (halves_.empty()) return pending_.least_done(uniform_.complete_passes_spp());
    return std::uint32_t(done_ / pixels());
}

std::uint32_t AdaptiveSchedule::samples_of(std::uint32_t pixel) const {
    if (halves_.empty()) return uniform_.complete_passes_spp();
    const std::uint32_t x = pixel % width_, y = pixel / width_;
    const std::uint32_t tile = y / tile_side * columns_ + x / tile_side, half = (x % tile_side + y % tile_side) % 2;
    return halves_[2 * tile + half] & ~chosen;
}

std::uint64_t AdaptiveSchedule::samples() const {
    if (halves_.empty()) return uniform_.samples() - pending_.samples();
    return done_ + std::uint64_t(entry_) * round_.unit + sample_;
}

AdaptiveSchedule::Position AdaptiveSchedule::position() const {
    return {in_round() ? PassSchedule::Position{0, 0, entry_, sample_} : uniform_.position(), halves_, pending_.list()};
}

bool AdaptiveSchedule::go_to(const Position& to) {
    const auto within = [](const PassSchedule::Position& at, std::uint64_t pixels) {
        return at.pixel < pixels && ((at.pixel == 0 && at.sample == 0) || at.sample < at.pass);
    };
    pending_ = PendingBatches(to.pending);
    if (to.halves.empty()) {
        uniform_.go_to(to.at);
        if (adaptive_) uniform_.extend(next_plan(to.at.done + (uniform_.between_passes() ? 0 : 1)));
        return within(to.at, pixels());
    }
    if (!adaptive_ || to.halves.size() != 2 * std::size_t(columns_) * rows_) return false;
    uniform_.go_to({first_samples, 0, 0, 0}), uniform_.extend(first_samples);
    halves_ = to.halves, done_ = 0;
    std::uint64_t round = 0;
    for (std::uint32_t h = 0; h < halves_.size(); ++h) {
        const std::uint32_t samples = halves_[h] & ~chosen;
        if (samples < first_samples || samples > most_samples || (samples & (samples - 1)) != 0) return false;
        done_ += std::uint64_t(samples) * pixels_of(h);
        if (halves_[h] & chosen) round += std::uint64_t(samples) * pixels_of(h);
    }
    if (done_ + round > budget_ || round / least_samples() > words_per_pixel / 2 * pixels()) return false;
    list_chosen();
    if (!in_round()) {
        has_ended_ = none_fits();
        return true;
    }
    entry_ = to.at.pixel, sample_ = to.at.sample;
    return to.at.done == 0 && to.at.pass == 0 && entry_ < round_.entries && sample_ < round_.unit;
}

}  // namespace claray
