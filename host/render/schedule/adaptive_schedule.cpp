#include "host/render/schedule/adaptive_schedule.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace claray {
namespace {

constexpr std::uint32_t tile_side = CLARAY_TILE_SIDE;
constexpr std::uint32_t first_samples = 16;  // per pixel, of the whole image: fewer tell little about the error
constexpr std::uint64_t parts_per_round = 4;
/// Every tile has at least this share of the mean number of samples, so that light which its first samples missed is
/// found in the end.
constexpr std::uint64_t least_share = 8;
constexpr std::uint32_t most_samples = 1u << 30;

std::uint32_t tiles_along(std::uint32_t side) { return (side + tile_side - 1) / tile_side; }

}  // namespace

AdaptiveSchedule::AdaptiveSchedule(std::uint32_t width, std::uint32_t height, std::uint32_t spp,
                                   std::uint32_t paths_in_flight, bool adaptive)
    : width_(width),
      height_(height),
      columns_(tiles_along(width)),
      rows_(tiles_along(height)),
      paths_(paths_in_flight),
      budget_(std::uint64_t(width) * height * spp),
      adaptive_(adaptive && spp > first_samples),
      uniform_(width * height, adaptive_ ? first_samples : spp, paths_in_flight) {}

std::uint32_t AdaptiveSchedule::pixels_of(std::uint32_t tile) const {
    const std::uint32_t x = tile % columns_ * tile_side, y = tile / columns_ * tile_side;
    return std::min(tile_side, width_ - x) * std::min(tile_side, height_ - y);
}

/// The squared error of n samples falls like 1/n or faster, so that doubling a tile gains about the estimated square
/// for n samples. The estimate of a single tile is rough: few samples may have missed what makes the noise. The mean of
/// the 3x3 tiles around it is a lower limit.
std::vector<double> AdaptiveSchedule::priorities(const std::vector<float>& variances) const {
    std::vector<double> result(tiles_.size());
    for (std::uint32_t t = 0; t < result.size(); ++t) {
        const std::uint32_t x = t % columns_, y = t / columns_;
        double sum = 0, count = 0;
        for (std::uint32_t v = y - std::min(y, 1u); v <= std::min(y + 1, rows_ - 1); ++v)
            for (std::uint32_t u = x - std::min(x, 1u); u <= std::min(x + 1, columns_ - 1); ++u)
                sum += double(variances[v * columns_ + u]), ++count;
        const bool lags = tiles_[t] * least_share * width_ * height_ < done_;
        result[t] =
            lags ? std::numeric_limits<double>::infinity() : std::max(double(variances[t]), sum / count) / tiles_[t];
    }
    return result;
}

void AdaptiveSchedule::plan(const std::vector<float>& variances) {
    if (tiles_.empty()) {
        tiles_.assign(std::size_t(columns_) * rows_, first_samples);
        done_ = std::uint64_t(width_) * height_ * first_samples;
    }
    const std::vector<double> priority = priorities(variances);
    std::vector<std::uint32_t> order(tiles_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return priority[a] > priority[b]; });
    const std::uint64_t left = budget_ - done_, wanted = std::min(left, done_ / parts_per_round);
    const std::uint32_t unit = least_samples();
    std::uint64_t taken = 0, room = std::uint64_t(words_per_pixel / 2) * width_ * height_;
    for (const std::uint32_t tile : order) {
        const std::uint64_t cost = std::uint64_t(tiles_[tile]) * pixels_of(tile);
        if (taken >= wanted) break;
        if (taken + cost > left || cost / unit > room || tiles_[tile] >= most_samples) continue;
        taken += cost, room -= cost / unit;
        tiles_[tile] |= chosen;
    }
    list_chosen();
    has_ended_ = listed_.empty();
}

std::uint32_t AdaptiveSchedule::least_samples() const {
    std::uint32_t least = most_samples;
    for (const std::uint32_t tile : tiles_) least = std::min(least, tile & ~chosen);
    return least;
}

void AdaptiveSchedule::list_chosen() {
    listed_.clear();
    entry_ = sample_ = 0, unit_ = least_samples();
    for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
        if (!(tiles_[t] & chosen)) continue;
        const std::uint32_t samples = tiles_[t] & ~chosen, x0 = t % columns_ * tile_side, y0 = t / columns_ * tile_side;
        for (std::uint32_t y = y0; y < std::min(y0 + tile_side, height_); ++y)
            for (std::uint32_t x = x0; x < std::min(x0 + tile_side, width_); ++x)
                for (std::uint32_t first = samples; first < 2 * samples; first += unit_)
                    listed_.push_back(y * width_ + x), listed_.push_back(first);
    }
}

void AdaptiveSchedule::end_round() {
    done_ = samples();
    for (std::uint32_t& tile : tiles_)
        if (tile & chosen) tile = 2 * (tile & ~chosen);
    listed_.clear();
    entry_ = sample_ = 0;
}

/// Each entry's samples are complete before the next entry begins, so that each pixel gets its samples in their order.
Batch AdaptiveSchedule::next(std::uint32_t most_paths) {
    if (listed_.empty()) return uniform_.next(most_paths);
    const std::uint32_t most = std::max(1u, std::min(most_paths, paths_));
    Batch batch{entry_, 1, sample_, std::min(unit_ - sample_, most), 1};
    if (batch.samples < unit_) {  // a part of one entry
        sample_ += batch.samples;
        if (sample_ == unit_) sample_ = 0, ++entry_;
    } else {
        batch.pixels = std::min(most / unit_, entries() - entry_);
        entry_ += batch.pixels;
    }
    if (entry_ == entries()) end_round();
    return batch;
}

std::uint32_t AdaptiveSchedule::complete_passes_spp() const {
    if (tiles_.empty()) return uniform_.complete_passes_spp();
    return std::uint32_t(done_ / (std::uint64_t(width_) * height_));
}

std::uint64_t AdaptiveSchedule::samples() const {
    if (tiles_.empty()) return uniform_.samples();
    return done_ + std::uint64_t(entry_) * unit_ + sample_;
}

AdaptiveSchedule::Position AdaptiveSchedule::position() const {
    return {listed_.empty() ? uniform_.position() : Schedule::Position{0, 0, entry_, sample_}, tiles_};
}

bool AdaptiveSchedule::go_to(const Position& to) {
    const auto within = [](const Schedule::Position& at, std::uint64_t pixels) {
        return at.pixel < pixels && ((at.pixel == 0 && at.sample == 0) || at.sample < at.pass);
    };
    if (to.tiles.empty()) {
        uniform_.go_to(to.at);
        return within(to.at, std::uint64_t(width_) * height_);
    }
    if (!adaptive_ || to.tiles.size() != std::size_t(columns_) * rows_) return false;
    uniform_.go_to({first_samples, 0, 0, 0});
    tiles_ = to.tiles, done_ = 0;
    std::uint64_t round = 0;
    for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
        const std::uint32_t samples = tiles_[t] & ~chosen;
        if (samples < first_samples || samples > most_samples || (samples & (samples - 1)) != 0) return false;
        done_ += std::uint64_t(samples) * pixels_of(t);
        if (tiles_[t] & chosen) round += std::uint64_t(samples) * pixels_of(t);
    }
    const std::uint64_t room = std::uint64_t(words_per_pixel / 2) * width_ * height_;
    if (done_ + round > budget_ || round / least_samples() > room) return false;
    list_chosen();
    if (listed_.empty()) return true;
    entry_ = to.at.pixel, sample_ = to.at.sample;
    return to.at.done == 0 && to.at.pass == 0 && entry_ < entries() && sample_ < unit_;
}

}  // namespace claray
