// The share of light that is missing because paths end at the depth limit.
#pragma once

#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// Estimated by separate paths. Blocks.
[[nodiscard]] double share_cut_off(const Wavefront& wavefront);

}  // namespace claray
