// Samples that an interrupted render of several devices left out.
#pragma once

#include <vector>

#include "claray/shared/path.h"

namespace claray {

/// Batches of pixels of the image, at most one for each pixel, by increasing pixels.
class PendingBatches {
public:
    PendingBatches() = default;
    explicit PendingBatches(std::vector<Batch> batches) : batches_(std::move(batches)) {}

    [[nodiscard]] bool empty() const { return batches_.empty(); }
    [[nodiscard]] const std::vector<Batch>& list() const { return batches_; }
    /// Takes a batch of at most this many paths, at least 1. Each pixel gets its samples in their order.
    [[nodiscard]] Batch next(std::uint32_t most_paths);
    /// Number of samples of all pixels.
    [[nodiscard]] std::uint64_t samples() const;
    /// The fewest samples that one of these pixels has so far, and at most `most`.
    [[nodiscard]] std::uint32_t least_done(std::uint32_t most) const;

private:
    std::vector<Batch> batches_;
};

}  // namespace claray
