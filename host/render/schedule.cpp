#include "host/render/schedule.hpp"

#include <algorithm>

namespace claray {
namespace {
constexpr std::uint32_t largest_pass = 16;  // samples a pixel, unless the whole image with more fits into one batch
}

Schedule::Schedule(std::uint32_t pixels, std::uint32_t spp, std::uint32_t paths_in_flight)
    : pixels_(pixels), spp_(spp), paths_(paths_in_flight) {}

std::uint32_t Schedule::pass_samples() const {
    const std::uint32_t limit = std::min(std::max(largest_pass, paths_ / pixels_), paths_);
    return std::min({std::max(done_, 1u), limit, spp_ - done_});
}

Batch Schedule::next() {
    Batch batch{};
    batch.first_pixel = pixel_;
    batch.first_sample = done_;
    batch.samples = pass_samples();
    batch.pixels = std::min(paths_ / batch.samples, pixels_ - pixel_);
    pixel_ += batch.pixels;
    if (pixel_ == pixels_) pixel_ = 0, done_ += batch.samples;
    return batch;
}

std::uint64_t Schedule::samples() const {
    const std::uint64_t of_this_pass = pixel_ == 0 ? 0 : std::uint64_t(pixel_) * pass_samples();
    return std::uint64_t(done_) * pixels_ + of_this_pass;
}

}  // namespace claray
