#include "host/render/schedule/pending_batches.hpp"

#include <algorithm>

namespace claray {

Batch PendingBatches::next(std::uint32_t most_paths) {
    if (Batch& last = batches_.back(); last.pixels > most_paths) {
        Batch end = last;
        last.pixels -= most_paths;
        end.first_pixel += last.pixels, end.pixels = most_paths;
        batches_.push_back(end);
    }
    Batch& left = batches_.back();
    Batch batch = left;
    batch.samples = std::min(left.samples, most_paths / left.pixels);
    left.first_sample += batch.samples, left.samples -= batch.samples;
    if (left.samples == 0) batches_.pop_back();
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
