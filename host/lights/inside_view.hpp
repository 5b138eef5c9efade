// A view from inside, for scenes that are rooms.
#pragma once

#include <optional>

#include "host/lights/light_probe.hpp"

namespace claray {

/// Returns a camera inside the largest room, with a wide and far view, if the scene is mostly rooms: fronts of surfaces
/// enclose at least a third of its box, and most of its surface area is in there. Hollow things, such as a vase, have
/// as much area outside. Returns nothing for other scenes.
[[nodiscard]] std::optional<Camera> inside_view(const ProbedScene& scene, float vertical_fov, float aspect);

}  // namespace claray
