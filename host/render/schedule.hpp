// Which pixels and samples are traced together, and in which order.
#pragma once

#include <cstdint>

#include "claray/shared/path.h"

namespace claray {

/// Goes over the image in passes of 1, 1, 2, 4, 8 ... samples a pixel, each cut into batches of whole pixels. Early
/// passes show the image soon; later ones give neighbouring paths the same pixel.
class Schedule {
public:
    Schedule(std::uint32_t pixels, std::uint32_t spp, std::uint32_t paths_in_flight);

    [[nodiscard]] bool finished() const { return done_ == spp_; }
    /// The next batch. Not to be called when finished.
    [[nodiscard]] Batch next();
    /// Samples that every pixel has.
    [[nodiscard]] std::uint32_t complete_passes_spp() const { return done_; }
    /// Samples of all pixels, those of an incomplete pass included.
    [[nodiscard]] std::uint64_t samples() const;
    [[nodiscard]] bool between_passes() const { return pixel_ == 0; }

private:
    [[nodiscard]] std::uint32_t pass_samples() const;

    std::uint32_t pixels_, spp_, paths_;
    std::uint32_t done_ = 0;   // samples a pixel before this pass
    std::uint32_t pixel_ = 0;  // where this pass goes on
};

}  // namespace claray
