// The rays of bench_peers: those of `claray bench`, or for any interior from within.
#pragma once

#include "bench/support.hpp"

namespace claray::measure {

/// Three views around the place, of 75 in the box, from which rays in all directions see farthest; the light is above
/// it, halfway to what is there.
[[nodiscard]] std::vector<View> views_from_inside(const Device& device, const Scene& scene);

}  // namespace claray::measure
