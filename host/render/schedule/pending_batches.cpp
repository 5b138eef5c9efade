#include "host/render/schedule/pending_batches.hpp"

#include <algorithm>

namespace claray {

/// All samples of as many pixels as there is room for, or a part of those of one pixel: neighbouring paths of one pixel
/// are faster, and the film is read and written once for all of them.
Batch PendingBatches::next(std::uint32_t most_paths) {
    Batch& left = batches_.back();
    Batch batch = left;
    batch.samples = std::min(left.samples, most_paths);
    batch.pixels = std::min(left.pixels, most_paths / batch.samples);
    Batch rest = batch;  // of the same pixels
    rest.first_sample += batch.samples, rest.samples = left.samples - batch.samples;
    left.pixels -= batch.pixels;
    batch.first_pixel = rest.first_pixel = left.first_pixel + left.pixels;
    if (left.pixels == 0) batches_.pop_back();
    if (rest.samples > 0) batches_.push_back(rest);
    return batch;
}

std::uint64_t PendingBatches::samples() const {
    std::uint64_t all = 0;
    for (const Batch& batch : batches_) all += std::uint64_t(batch.pixels) * batch.samples;
    return all;
}

std::uint32_t PendingBatches::least_done(std::uint32_t most) const {
    for (const Batch& batch : batches_) most = std::min(most, batch.first_sample);
    return most;
}

}  // namespace claray
