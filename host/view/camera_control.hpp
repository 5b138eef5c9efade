// Moves of a camera. All keep its field of view and its up vector.
#pragma once

#include <string>

#include "claray/scene.hpp"

namespace claray::view {

/// Turns the position round the target; stops 1 degree before the poles of the up vector.
[[nodiscard]] Camera orbit(const Camera& camera, float right_degrees, float up_degrees);
/// Turns the target round the position in the same way.
[[nodiscard]] Camera turn(const Camera& camera, float right_degrees, float up_degrees);
/// Shifts position and target across the view, in heights of the image at the target's distance.
/// The way of a point that moves along the image by these shares of the image's height.
[[nodiscard]] glm::vec3 along_image(const Camera& camera, const glm::vec3& point, float right, float up);
[[nodiscard]] Camera pan(const Camera& camera, float right, float up);
/// Shifts position and target along the view and across it, in units of the scene.
[[nodiscard]] Camera fly(const Camera& camera, float forward, float right, float up);
/// Divides the distance from the target by `factor` > 0. An orthographic camera's image becomes smaller instead.
[[nodiscard]] Camera zoom(const Camera& camera, float factor);

/// Returns the unit vector of the ray through the centre of pixel x, y, counted from the top left.
[[nodiscard]] glm::vec3 direction_through(const CameraData& camera, unsigned x, unsigned y, unsigned width,
                                          unsigned height);

/// Returns the point at this distance on that ray. Rays of an orthographic camera start in the plane of its position.
[[nodiscard]] glm::vec3 point_through(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height,
                                      float distance);

/// Returns the camera as options of `claray render`, with as many digits as float32 needs.
[[nodiscard]] std::string options_of(const Camera& camera);

}  // namespace claray::view
