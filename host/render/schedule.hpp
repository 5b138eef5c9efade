// Decides which pixels and samples are traced together, and in which order.
#pragma once

#include <cstdint>

#include "claray/shared/path.h"

namespace claray {

/// Goes over the image in passes of 1, 1, 2, 4, 8 ... samples a pixel, each cut into batches of whole pixels. Early
/// passes show the image soon; later ones give neighbouring paths the same pixel. However they are cut, every pixel
/// gets its samples in the same order, so that its sums are the same bit for bit.
class Schedule {
public:
    Schedule(std::uint32_t pixels, std::uint32_t spp, std::uint32_t paths_in_flight);

    [[nodiscard]] bool finished() const { return at_.done == spp_; }
    /// The next batch, of at most so many paths. Not to be called when finished.
    [[nodiscard]] Batch next(std::uint32_t most_paths = ~std::uint32_t(0));
    /// Samples that every pixel has.
    [[nodiscard]] std::uint32_t complete_passes_spp() const { return at_.done; }
    /// Samples of all pixels, those of an incomplete pass included.
    [[nodiscard]] std::uint64_t samples() const;
    [[nodiscard]] bool between_passes() const { return at_.pixel == 0 && at_.sample == 0; }
    /// Lets the next pass have no more samples a pixel than these; between passes.
    void limit_pass(std::uint32_t samples) { most_samples_ = samples; }

    struct Position {
        std::uint32_t done = 0;    // samples a pixel before this pass
        std::uint32_t pass = 0;    // samples a pixel of this pass, once it has begun
        std::uint32_t pixel = 0;   // where this pass goes on
        std::uint32_t sample = 0;  // of that pixel in this pass
    };
    [[nodiscard]] const Position& position() const { return at_; }
    void go_to(const Position& position) { at_ = position; }

private:
    [[nodiscard]] std::uint32_t pass_samples() const;

    std::uint32_t pixels_, spp_, paths_;
    std::uint32_t most_samples_ = ~std::uint32_t(0);
    Position at_;
};

/// How many paths a batch may have for the device to be done with it in about a tenth of a second: no command of it
/// lasts longer, however slow device and scene are (drivers reset devices that seem to hang), and a stop takes effect
/// soon.
class Pace {
public:
    Pace(std::uint32_t first, std::uint32_t most) : paths_(first < most ? first : most), most_(most) {}

    [[nodiscard]] std::uint32_t paths() const { return paths_; }
    /// The same, of a batch that shall be done within this time, as far as is known how long paths take.
    [[nodiscard]] std::uint32_t paths_within(double milliseconds) const;
    /// How long so many paths take; 0 while it is not known.
    [[nodiscard]] double milliseconds_of(std::uint64_t paths) const { return double(paths) * milliseconds_a_path_; }
    /// So long a batch of so many paths has taken.
    void took(std::uint32_t paths, double milliseconds);

private:
    std::uint32_t paths_, most_;
    double milliseconds_a_path_ = 0;
};

}  // namespace claray
