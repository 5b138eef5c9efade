// Decides which pixels of an image get more samples than others.
#pragma once

#include <optional>
#include <vector>

#include "host/render/schedule/schedule.hpp"

namespace claray {

/// A Schedule of the whole image, and with adaptive sampling rounds after its first 16 samples per pixel. Each round
/// doubles the samples of the tiles (8x8 pixels) in which a sample lowers the estimated squared error of the image
/// most, about a quarter of all samples so far. It is planned from complete earlier rounds only, so that it depends
/// neither on batches nor on time. Tiles keep powers of two, where Sobol points are even.
class AdaptiveSchedule {
public:
    /// `spp`: mean samples per pixel at the end. `paths_in_flight`: see Schedule.
    AdaptiveSchedule(std::uint32_t width, std::uint32_t height, std::uint32_t spp, std::uint32_t paths_in_flight,
                     bool adaptive);

    [[nodiscard]] bool finished() const { return has_ended_ || (!adaptive_ && uniform_.finished()); }
    /// Returns whether `plan` must be called before `next`.
    [[nodiscard]] bool wants_plan() const { return adaptive_ && !has_ended_ && uniform_.finished() && groups_.empty(); }
    /// Returns whether pixels may have different numbers of samples.
    [[nodiscard]] bool has_rounds() const { return !tiles_.empty(); }
    /// Plans the next round from the variance of each pixel's mean, in any unit. If no tile can be doubled within the
    /// samples left, the schedule is finished.
    void plan(const std::vector<float>& variances);
    /// The pixels that the batches of this round number; empty if they number those of the image.
    [[nodiscard]] const std::vector<std::uint32_t>& listed() const { return listed_; }
    /// As of Schedule; with adaptive sampling, samples per pixel are means, and passes are rounds.
    [[nodiscard]] Batch next(std::uint32_t most_paths = ~std::uint32_t(0));
    [[nodiscard]] std::uint32_t complete_passes_spp() const;
    [[nodiscard]] std::uint64_t samples() const;
    [[nodiscard]] bool between_passes() const { return groups_.empty() && uniform_.between_passes(); }
    void limit_pass(std::uint32_t samples) { uniform_.limit_pass(samples); }
    /// Samples per pixel of the current pass of the whole image, or of the next one.
    [[nodiscard]] std::uint32_t pass_samples() const { return uniform_.pass_samples(); }

    struct Position {
        Schedule::Position at;  // of the image, or of the group of tiles that is sampled now
        std::uint32_t group = 0;
        /// Of each tile, once rounds have begun: samples per pixel before the round, and `chosen` if the round doubles
        /// them.
        std::vector<std::uint32_t> tiles;
    };
    static constexpr std::uint32_t chosen = 1u << 31;
    [[nodiscard]] Position position() const;
    /// Returns false if no schedule of this image can be at this position.
    [[nodiscard]] bool go_to(const Position& position);

private:
    /// Chosen tiles with the same number of samples: consecutive pixels of the list.
    struct Group {
        std::uint32_t first = 0, pixels = 0, samples = 0;
    };
    [[nodiscard]] std::uint32_t pixels_of(std::uint32_t tile) const;
    [[nodiscard]] std::vector<double> priorities(const std::vector<float>& variances) const;
    void list_chosen();
    void begin_group(std::uint32_t group);
    void end_round();

    std::uint32_t width_, height_, columns_, rows_, paths_;
    std::uint64_t budget_;  // samples of all pixels
    bool adaptive_, has_ended_ = false;
    Schedule uniform_;
    std::vector<std::uint32_t> tiles_;  // as in Position
    std::uint64_t done_ = 0;            // samples of all pixels before the round
    std::vector<std::uint32_t> listed_;
    std::vector<Group> groups_;  // of the round; empty between rounds
    std::uint32_t group_ = 0;
    std::optional<Schedule> current_;  // of the group
};

}  // namespace claray
