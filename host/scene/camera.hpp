// Rays of a camera, on the host.
#pragma once

#include "claray/scene.hpp"

namespace claray {

struct CameraRay {
    glm::dvec3 origin, direction;  ///< not of length 1
};
/// Returns the ray through a point of the image, -1 to 1 on both axes, y upwards, at shutter open and through the
/// middle of the lens: what camera_ray of kernels/shade/camera.clh returns before it normalises.
[[nodiscard]] CameraRay camera_ray(const CameraData& camera, double x, double y);

}  // namespace claray
