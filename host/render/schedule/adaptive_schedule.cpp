#include "host/render/schedule/adaptive_schedule.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace claray {
namespace {

constexpr std::uint32_t tile_side = 8;
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
    std::vector<double> squares(tiles_.size());
    for (std::size_t i = 0; i < variances.size(); ++i)
        squares[i / width_ / tile_side * columns_ + i % width_ / tile_side] += variances[i];
    for (std::uint32_t t = 0; t < squares.size(); ++t) squares[t] /= pixels_of(t);
    std::vector<double> result(tiles_.size());
    for (std::uint32_t t = 0; t < result.size(); ++t) {
        const std::uint32_t x = t % columns_, y = t / columns_;
        double sum = 0, count = 0;
        for (std::uint32_t v = y - std::min(y, 1u); v <= std::min(y + 1, rows_ - 1); ++v)
            for (std::uint32_t u = x - std::min(x, 1u); u <= std::min(x + 1, columns_ - 1); ++u)
                sum += squares[v * columns_ + u], ++count;
        const bool lags = tiles_[t] * least_share * width_ * height_ < done_;
        result[t] = lags ? std::numeric_limits<double>::infinity() : std::max(squares[t], sum / count) / tiles_[t];
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
    std::uint64_t taken = 0;
    for (const std::uint32_t tile : order) {
        const std::uint64_t cost = std::uint64_t(tiles_[tile]) * pixels_of(tile);
        if (taken >= wanted) break;
        if (taken + cost > left || tiles_[tile] >= most_samples) continue;
        taken += cost;
        tiles_[tile] |= chosen;
    }
    list_chosen();
    has_ended_ = groups_.empty();
}

void AdaptiveSchedule::list_chosen() {
    listed_.clear(), groups_.clear(), current_.reset();
    std::vector<std::uint32_t> order;
    for (std::uint32_t t = 0; t < tiles_.size(); ++t)
        if (tiles_[t] & chosen) order.push_back(t);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return tiles_[a] < tiles_[b]; });
    for (const std::uint32_t tile : order) {
        const std::uint32_t samples = tiles_[tile] & ~chosen, x0 = tile % columns_ * tile_side,
                            y0 = tile / columns_ * tile_side;
        if (groups_.empty() || groups_.back().samples != samples)
            groups_.push_back({std::uint32_t(listed_.size()), 0, samples});
        for (std::uint32_t y = y0; y < std::min(y0 + tile_side, height_); ++y)
            for (std::uint32_t x = x0; x < std::min(x0 + tile_side, width_); ++x) listed_.push_back(y * width_ + x);
        groups_.back().pixels += pixels_of(tile);
    }
    if (!groups_.empty()) begin_group(0);
}

void AdaptiveSchedule::begin_group(std::uint32_t group) {
    group_ = group;
    const Group& of = groups_[group];
    current_.emplace(of.pixels, 2 * of.samples, paths_);
    current_->go_to({of.samples, 0, 0, 0});
}

void AdaptiveSchedule::end_round() {
    done_ = samples();
    for (std::uint32_t& tile : tiles_)
        if (tile & chosen) tile = 2 * (tile & ~chosen);
    listed_.clear(), groups_.clear(), current_.reset();
    group_ = 0;
}

Batch AdaptiveSchedule::next(std::uint32_t most_paths) {
    if (!current_) return uniform_.next(most_paths);
    Batch batch = current_->next(most_paths);
    batch.first_pixel += groups_[group_].first;
    batch.listed = 1;
    if (!current_->finished()) return batch;
    if (group_ + 1 < groups_.size())
        begin_group(group_ + 1);
    else
        end_round();
    return batch;
}

std::uint32_t AdaptiveSchedule::complete_passes_spp() const {
    if (tiles_.empty()) return uniform_.complete_passes_spp();
    return std::uint32_t(done_ / (std::uint64_t(width_) * height_));
}

std::uint64_t AdaptiveSchedule::samples() const {
    if (tiles_.empty()) return uniform_.samples();
    if (!current_) return done_;
    std::uint64_t all = done_;
    for (std::uint32_t g = 0; g < group_; ++g) all += std::uint64_t(groups_[g].pixels) * groups_[g].samples;
    return all + current_->samples() - std::uint64_t(groups_[group_].pixels) * groups_[group_].samples;
}

AdaptiveSchedule::Position AdaptiveSchedule::position() const {
    return {current_ ? current_->position() : uniform_.position(), group_, tiles_};
}

bool AdaptiveSchedule::go_to(const Position& to) {
    const auto within = [](const Schedule::Position& at, std::uint64_t pixels) {
        return at.pixel < pixels && ((at.pixel == 0 && at.sample == 0) || at.sample < at.pass);
    };
    if (to.tiles.empty()) {
        uniform_.go_to(to.at);
        return to.group == 0 && within(to.at, std::uint64_t(width_) * height_);
    }
    if (!adaptive_ || to.tiles.size() != std::size_t(columns_) * rows_) return false;
    uniform_.go_to({first_samples, 0, 0, 0});
    tiles_ = to.tiles, done_ = 0;
    for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
        const std::uint32_t samples = tiles_[t] & ~chosen;
        if (samples < first_samples || samples > most_samples || (samples & (samples - 1)) != 0) return false;
        done_ += std::uint64_t(samples) * pixels_of(t);
    }
    list_chosen();
    if (groups_.empty()) return to.group == 0 && done_ <= budget_;
    if (to.group >= groups_.size() || !within(to.at, groups_[to.group].pixels)) return false;
    begin_group(to.group);
    const std::uint32_t samples = groups_[to.group].samples;
    const bool in_pass = to.at.pixel != 0 || to.at.sample != 0;
    if (to.at.done < samples || to.at.done >= 2 * samples) return false;
    if (in_pass && to.at.pass > 2 * samples - to.at.done) return false;
    current_->go_to(to.at);
    return this->samples() <= budget_;
}

}  // namespace claray
