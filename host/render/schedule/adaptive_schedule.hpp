// Decides which pixels of an image get more samples than others.
#pragma once

#include <vector>

#include "host/render/schedule/pass_schedule.hpp"
#include "host/render/schedule/pending_batches.hpp"

namespace claray {

/// A PassSchedule of the whole image, and with adaptive sampling rounds after its first 16 samples per pixel. Each
/// round doubles the samples of the half tiles in which a sample lowers the estimated squared error of the image most,
/// about a quarter of all samples so far. Tiles are squares of 8x8 pixels, and their halves are the two colours of a
/// checkerboard. The error of a half is estimated from other halves, whose samples are independent: chosen by its own
/// samples, a pixel that has missed a light by chance would get fewer, and its mean would be biased. While the error is
/// spread so evenly that this does not pay, the whole image is doubled instead. All is planned from complete earlier
/// rounds only, so that it depends neither on batches nor on time. Halves keep powers of two, where Sobol points are
/// even.
class AdaptiveSchedule {
public:
    /// The entries that the batches of a round number (Batch): those of each chosen half tile, pixel by pixel in rows.
    /// An entry has `unit` samples, as many as the pixels with the fewest before the round.
    struct Round {
        /// Three words each: half h of tile t as 2 t + h, its samples per pixel so far, its first entry.
        std::vector<std::uint32_t> halves;
        std::uint32_t entries = 0, unit = 0;
        bool operator==(const Round&) const = default;
    };

    /// `spp`: mean samples per pixel at the end. `paths_in_flight`: see PassSchedule. `least_gain`: rounds begin where
    /// the best distribution of samples has this many times less squared error than the same number everywhere, in 99
    /// of 100 half tiles.
    AdaptiveSchedule(std::uint32_t width, std::uint32_t height, std::uint32_t spp, std::uint32_t paths_in_flight,
                     bool adaptive, double least_gain = 1.3);

    [[nodiscard]] bool finished() const {
        return pending_.empty() && (has_ended_ || (halves_.empty() && uniform_.complete_passes_spp() == spp_));
    }
    /// Returns whether `plan` must be called before `next`.
    [[nodiscard]] bool wants_plan() const {
        return pending_.empty() && !finished() && uniform_.finished() && !in_round();
    }
    /// Returns whether pixels may have different numbers of samples.
    [[nodiscard]] bool has_rounds() const { return !halves_.empty(); }
    /// Plans the next round from the variance of the pixels of each half tile, or what is to be minimized instead
    /// (Film::gain_per_sample), in any unit. If no half can be doubled within the samples left, the schedule is
    /// finished.
    void plan(const std::vector<float>& variances);
    /// Returns whether batches number the entries of a round, not the pixels of the image.
    [[nodiscard]] bool in_round() const { return !round_.halves.empty(); }
    /// Its entries have two words each (Batch), at most `words_per_pixel` words per pixel of the image.
    [[nodiscard]] const Round& round() const { return round_; }
    static constexpr std::uint32_t words_per_pixel = 8;
    /// As of PassSchedule; with adaptive sampling, samples per pixel are means, and passes are rounds. Pending samples
    /// count as a pass of their own.
    [[nodiscard]] Batch next(std::uint32_t most_paths = ~std::uint32_t(0));
    [[nodiscard]] std::uint32_t complete_passes_spp() const;
    [[nodiscard]] std::uint64_t samples() const;
    /// Samples of a pixel; between passes.
    [[nodiscard]] std::uint32_t samples_of(std::uint32_t pixel) const;
    [[nodiscard]] bool between_passes() const { return pending_.empty() && !in_round() && uniform_.between_passes(); }
    /// Continues up to more samples per pixel; not with adaptive sampling.
    void extend(std::uint32_t spp) { spp_ = spp, budget_ = pixels() * spp, uniform_.extend(spp); }
    void limit_pass(std::uint32_t samples) { uniform_.limit_pass(samples); }
    /// Samples per pixel of the current pass of the whole image, or of the next one.
    [[nodiscard]] std::uint32_t pass_samples() const { return uniform_.pass_samples(); }

    struct Position {
        PassSchedule::Position at;  // of the image; in a round the entry and its sample
        /// Of each half tile, once rounds have begun: samples per pixel before the round, and `chosen` if the round
        /// doubles them.
        std::vector<std::uint32_t> halves;
        /// Samples before `at` that are missing, because several devices shared the image: they come first.
        std::vector<Batch> pending = {};
    };
    static constexpr std::uint32_t chosen = 1u << 31;
    [[nodiscard]] Position position() const;
    /// Returns false if no schedule of this image can be at this position.
    [[nodiscard]] bool go_to(const Position& position);

private:
    [[nodiscard]] std::uint32_t pixels_of(std::uint32_t half) const;
    /// Samples per pixel of the half tile with the fewest, before the round.
    [[nodiscard]] std::uint32_t least_samples() const;
    [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t(width_) * height_; }
    [[nodiscard]] std::vector<double> estimate_from_other_halves(const std::vector<float>& variances) const;
    /// By how much the best distribution of all samples would lower the squared error of nearly all half tiles.
    [[nodiscard]] double gain(const std::vector<float>& variances) const;
    void choose(const std::vector<double>& variances);
    /// The samples per pixel up to which the whole image is sampled before the next plan.
    [[nodiscard]] std::uint32_t next_plan(std::uint32_t samples) const;
    /// Returns whether the samples left are too few to double a whole tile.
    [[nodiscard]] bool none_fits() const;
    void list_chosen();
    void end_round();

    std::uint32_t width_, height_, columns_, rows_, spp_, paths_;
    std::uint64_t budget_;  // samples of all pixels
    bool adaptive_, has_ended_ = false;
    double least_gain_;
    PassSchedule uniform_;
    std::vector<std::uint32_t> halves_;  // as in Position
    std::uint64_t done_ = 0;             // samples of all pixels before the round
    Round round_;
    std::uint32_t entry_ = 0, sample_ = 0;  // where the round continues
    PendingBatches pending_;
};

}  // namespace claray
