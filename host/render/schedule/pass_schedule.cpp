#include "host/render/schedule/pass_schedule.hpp"

#include <algorithm>

namespace claray {
namespace {
constexpr std::uint32_t largest_pass = 16;  // samples per pixel, unless the whole image with more fits into one batch
constexpr double batch_milliseconds = 100;
constexpr double kept = 0.75;  // of the weight of earlier batches, with each further one
}  // namespace

PassSchedule::PassSchedule(std::uint32_t pixels, std::uint32_t spp, std::uint32_t paths_in_flight)
    : pixels_(pixels), spp_(spp), paths_(paths_in_flight) {}

std::uint32_t PassSchedule::longest_pass(std::uint32_t pixels, std::uint32_t paths) {
    return std::min(std::max(largest_pass, paths / pixels), paths);
}

/// Does not depend on anything that differs between runs, because a render may stop between passes.
std::uint32_t PassSchedule::pass_samples() const {
    if (!between_passes()) return at_.pass;
    return std::min({std::max(at_.done, 1u), longest_pass(pixels_, paths_), spp_ - at_.done, most_samples_});
}

Batch PassSchedule::next(std::uint32_t most_paths) {
    const std::uint32_t most = std::max(1u, std::min(most_paths, paths_));
    at_.pass = pass_samples();
    Batch batch{};
    batch.first_pixel = at_.pixel;
    batch.first_sample = at_.done + at_.sample;
    batch.samples = std::min(at_.pass - at_.sample, most);
    batch.pixels = 1;
    if (batch.samples < at_.pass) {  // a part of one pixel
        at_.sample += batch.samples;
        if (at_.sample < at_.pass) return batch;
        at_.sample = 0;
    } else {
        batch.pixels = std::min(most / batch.samples, pixels_ - at_.pixel);
    }
    at_.pixel += batch.pixels;
    if (at_.pixel == pixels_) at_.pixel = 0, at_.done += at_.pass, most_samples_ = ~std::uint32_t(0);
    return batch;
}

std::uint64_t PassSchedule::samples() const {
    return std::uint64_t(at_.done) * pixels_ + std::uint64_t(at_.pixel) * pass_samples() + at_.sample;
}

std::uint32_t Pace::paths_within(double milliseconds) const {
    if (!(milliseconds_a_path() > 0)) return paths_;
    return std::uint32_t(std::clamp(milliseconds / milliseconds_a_path(), 1.0, double(paths_)));
}

/// A batch that took too long reduces the size at once. Only full batches can raise it: the time of small ones is
/// mostly overhead.
void Pace::took(std::uint32_t paths, double milliseconds) {
    known_paths_ = kept * known_paths_ + double(paths), milliseconds_ = kept * milliseconds_ + milliseconds;
    const double share = batch_milliseconds / std::max(milliseconds, 1e-3);
    if (share < 1)
        paths_ = std::min(paths_, std::uint32_t(std::max(1.0, double(paths) * std::max(share, 0.125))));
    else if (paths > paths_ / 2)
        paths_ = std::max(paths_, std::uint32_t(std::min(double(most_), double(paths) * std::min(share, 4.0))));
}

}  // namespace claray
