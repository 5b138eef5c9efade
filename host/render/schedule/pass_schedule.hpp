// Decides which pixels and samples are traced together, and in which order.
#pragma once

#include <cstdint>

#include "claray/shared/path.h"

namespace claray {

/// Covers the image in passes of 1, 1, 2, 4, 8 ... samples per pixel, each divided into batches of whole pixels. Early
/// passes show the image soon; in later ones neighbouring paths have the same pixel. Each pixel gets its samples in the
/// same order for any division, so that its sums are the same bit for bit.
class PassSchedule {
public:
    /// Samples per pixel of the longest pass.
    [[nodiscard]] static std::uint32_t longest_pass(std::uint32_t pixels, std::uint32_t paths_in_flight);
    PassSchedule(std::uint32_t pixels, std::uint32_t spp, std::uint32_t paths_in_flight);

    [[nodiscard]] bool finished() const { return at_.done == spp_; }
    /// The next batch of at most this many paths. Must not be called when finished.
    [[nodiscard]] Batch next(std::uint32_t most_paths = ~std::uint32_t(0));
    /// Number of samples that every pixel has.
    [[nodiscard]] std::uint32_t complete_passes_spp() const { return at_.done; }
    /// Number of samples of all pixels, including those of an incomplete pass.
    [[nodiscard]] std::uint64_t samples() const;
    [[nodiscard]] bool between_passes() const { return at_.pixel == 0 && at_.sample == 0; }
    /// Continues up to more samples per pixel.
    void extend(std::uint32_t spp) { spp_ = spp; }
    /// Limits the samples per pixel of the next pass; to be called between passes.
    void limit_pass(std::uint32_t samples) { most_samples_ = samples; }

    /// Samples per pixel of this pass, or of the next one.
    [[nodiscard]] std::uint32_t pass_samples() const;

    struct Position {
        std::uint32_t done = 0;    // samples per pixel before this pass
        std::uint32_t pass = 0;    // samples per pixel of this pass, once it has begun
        std::uint32_t pixel = 0;   // where this pass continues
        std::uint32_t sample = 0;  // of that pixel in this pass
    };
    [[nodiscard]] const Position& position() const { return at_; }
    void go_to(const Position& position) { at_ = position; }

private:
    std::uint32_t pixels_, spp_, paths_;
    std::uint32_t most_samples_ = ~std::uint32_t(0);
    Position at_;
};

/// The number of paths in a batch that takes the device about a tenth of a second. Then no command takes longer,
/// however slow the device or the scene is (drivers reset devices that seem to hang), and a stop takes effect soon.
class Pace {
public:
    Pace(std::uint32_t first, std::uint32_t most) : paths_(first < most ? first : most), most_(most) {}

    [[nodiscard]] std::uint32_t paths() const { return paths_; }
    /// The same for a batch that must be done within this time, if the time of paths is known.
    [[nodiscard]] std::uint32_t paths_within(double milliseconds) const;
    /// The time for this many paths; 0 while it is unknown.
    [[nodiscard]] double milliseconds_of(std::uint64_t paths) const { return double(paths) * milliseconds_a_path(); }
    /// Reports the time that a batch of this many paths took.
    void took(std::uint32_t paths, double milliseconds);

private:
    /// Of the last batches, each by its paths: a few paths into the sky tell little of the rest of the image.
    [[nodiscard]] double milliseconds_a_path() const { return known_paths_ > 0 ? milliseconds_ / known_paths_ : 0; }

    std::uint32_t paths_, most_;
    double known_paths_ = 0, milliseconds_ = 0;  // of all batches, the earlier the less
};

}  // namespace claray
