// A grid over lights with a position: for each cell the lights that may reach it. "Clustered Deferred and Forward
// Shading" (Olsson, Billeter and Assarsson 2012), with cells of the world instead of the view, so that mirrors, lenses
// and later surfaces of a path use it too, and a camera that moves does not change it.
#pragma once

#include <span>
#include <vector>

#include "claray/shared/scene.h"

namespace claray {

/// Returns a LightLists, the starts of the cells' lists and of the list of what is outside the grid, their end, and the
/// lists: indices in `lights`. A list has every light that reaches a point of the cell. The grid covers what lights
/// with a range reach; without them it has no cells.
[[nodiscard]] std::vector<std::uint32_t> build_light_lists(std::span<const PunctualLight> lights);

/// Returns the mean length of such lists at the places of the lights with a range; of many lights, at the places of
/// some. Infinite if lights without a range would fill too many lists.
[[nodiscard]] double mean_list_length(std::span<const PunctualLight> lights);

}  // namespace claray
