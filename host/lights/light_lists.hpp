// A grid over lights with a range: for each cell the lights that may reach it. "Clustered Deferred and Forward Shading"
// (Olsson, Billeter and Assarsson 2012), with cells of the world instead of the view, so that mirrors, lenses and later
// surfaces of a path use it too, and a camera that moves does not change it.
#pragma once

#include <span>
#include <vector>

#include "claray/shared/scene.h"

namespace claray {

/// Returns a LightLists, the starts of the cells' lists and their end, and the lists: indices in `lights`, which all
/// have a range. A list has every light that reaches a point of the cell.
[[nodiscard]] std::vector<std::uint32_t> build_light_lists(std::span<const PunctualLight> lights);

/// Returns the mean length of such lists at the places of the lights; of many lights, at the places of some.
[[nodiscard]] double mean_list_length(std::span<const PunctualLight> lights);

}  // namespace claray
