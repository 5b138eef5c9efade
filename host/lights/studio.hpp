// A neutral studio: light for scenes that have none.
#pragma once

#include "claray/scene.hpp"

namespace claray {

/// Returns a grey room with soft panels as an environment: a large one above and to the left of the camera, a dim one
/// on its right, one overhead and two narrow ones behind what it looks at. The panels are outside of the camera's view.
/// A white surface that faces the camera and slightly upwards reflects a radiance of about 1.
[[nodiscard]] Environment studio(const Camera& camera);

}  // namespace claray
