// When a render to an error will end, from what its first samples tell.
#pragma once

#include <optional>

#include "claray/renderer.hpp"

namespace claray {

/// What is foreseen from the pace and the last error that is known.
struct Forecast {
    double spp = 0, seconds = 0;  // that the error needs
    double seconds_a_sample = 0;  // for every pixel
};

/// A render whose reports are watched.
class Watched {
public:
    /// Takes note of a report. Nothing until an error is known and `least_seconds` have passed with the scene's own
    /// kernels.
    std::optional<Forecast> foresee(const RenderProgress& so_far, double error, double least_seconds);

private:
    [[nodiscard]] double convergence(const RenderProgress& so_far) const;
    [[nodiscard]] Forecast forecast(const RenderProgress& so_far, double error) const;

    std::optional<RenderProgress> pace_;   // since when the scene's own kernels render
    std::optional<RenderProgress> error_;  // the first that tells one
};

}  // namespace claray
