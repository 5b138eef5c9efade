// What stb_image trusts in a Radiance image.
#pragma once

#include <string_view>

namespace claray {

/// False where the runs of an image of this size don't fill its rows, or go on behind the end of the file: stb_image
/// (2022) reads zeros there, takes them for runs of no length, and never ends.
[[nodiscard]] bool hdr_runs_fit(std::string_view bytes, unsigned width, unsigned height);

}  // namespace claray
