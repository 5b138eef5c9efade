// Transparent bodies with something within: other bodies, lamps, lights. Rays must know the media that they are in
// (kernels/shade/media.clh).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// The materials of transparent bodies by their rank, the lowest first: where bodies overlap, the last of them is
/// there. A body within another one outranks it; else the higher index of refraction does. Empty if nothing lies
/// within any body. Materials of open meshes are left out, since their bodies have no inside.
[[nodiscard]] std::vector<std::uint32_t> nested_media(const Scene& scene);

/// The scene with bodies that touch overlapping: those of lower rank grow by 1e-5 of their size, far more than rounding
/// and far less than is visible. Rays would see only one of two borders in the same place. Nothing if none touch.
[[nodiscard]] std::optional<Scene> with_overlapping_media(const Scene& scene);

}  // namespace claray
