// Planning: predicts from the first samples when a render will reach an error.
#pragma once

#include <optional>

#include "claray/plan/target.hpp"

namespace claray {

/// Prediction from the pace and the last known error.
struct Forecast {
    double spp = 0, seconds = 0;  // until the error is reached
    double seconds_a_sample = 0;  // for every pixel
};

/// Watches the reports of a render.
class Watched {
public:
    /// Records a report. Returns nothing until an error is known and `least_seconds` have passed with the scene's own
    /// kernels.
    std::optional<Forecast> foresee(const RenderProgress& so_far, double error, double least_seconds);

private:
    [[nodiscard]] double convergence(const RenderProgress& so_far) const;
    [[nodiscard]] Forecast forecast(const RenderProgress& so_far, double error) const;

    std::optional<RenderProgress> pace_;   // first report of the scene's own kernels
    std::optional<RenderProgress> error_;  // first report with an error
};

/// Picks sampler and tree for so many seconds of sampling; see plan_render.
void pick_for_time(TargetPlan& plan, const Device& device, double seconds);

}  // namespace claray
