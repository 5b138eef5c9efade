// Checks data in a Radiance image that stb_image does not check.
#pragma once

#include <string_view>

namespace claray {

/// Returns false if the runs of an image of this size do not fill its rows, or continue beyond the end of the file:
/// stb_image (2022) then reads zeros as runs of length 0 and does not terminate.
[[nodiscard]] bool hdr_runs_fit(std::string_view bytes, unsigned width, unsigned height);

}  // namespace claray
