// What the page shows beside the image, as JSON.
#pragma once

#include <string>

#include "host/view/view.hpp"

namespace claray::view {

/// Objects, materials, lights, effects and settings, with what can be changed and the curve of the noise so far.
/// `has_job`: whether the page can save a job.
[[nodiscard]] std::string describe(const View& view, bool has_job);
/// What belongs to one frame: one line in ASCII, short enough for a header.
[[nodiscard]] std::string describe_frame(const View& view, const Frame& frame, const Answer& told);

}  // namespace claray::view
