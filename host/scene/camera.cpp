#include <algorithm>
#include <cmath>

#include "claray/error.hpp"
#include "claray/scene.hpp"

namespace claray {
namespace {

bool finite(const glm::vec3& v) { return !glm::any(glm::isnan(v)) && !glm::any(glm::isinf(v)); }

[[noreturn]] void refuse(const char* what, const char* remedy) {
    throw Error(ErrorKind::usage, std::string("camera: ") + what, remedy);
}

}  // namespace

Camera automatic_camera(const Bounds& bounds, float vertical_fov, float aspect) {
    // From the front, about 24 degrees from the right and 16 degrees from above.
    const glm::dvec3 towards_camera = glm::normalize(glm::dvec3(0.45, 0.3, 1.0));
    const glm::dvec3 center = bounds.empty() ? glm::dvec3(0.0) : glm::dvec3(bounds.center());
    const double radius = bounds.empty() ? 0.0 : 0.5 * glm::length(glm::dvec3(bounds.hi) - glm::dvec3(bounds.lo));

    // The sphere touches the frustum's narrower pair of planes at sin(half angle) = radius / distance.
    const double half_vertical = 0.5 * glm::radians(double(vertical_fov));
    const double half_horizontal = std::atan(std::tan(half_vertical) * aspect);
    double distance = radius / std::sin(std::min(half_vertical, half_horizontal));
    // A point far from the origin must not swallow the step back from it.
    if (!(radius > 0.0)) distance = std::max(1.0, 1e-6 * glm::length(center));

    Camera camera;
    camera.position = glm::vec3(center + distance * towards_camera);
    camera.target = glm::vec3(center);
    camera.vertical_fov = vertical_fov;
    return camera;
}

CameraData camera_data(const Camera& camera, float aspect) {
    if (!finite(camera.position) || !finite(camera.target) || !finite(camera.up))
        refuse("a coordinate is not finite", "give three numbers each for position, target and up");
    if (!(camera.vertical_fov > 0.f && camera.vertical_fov < 180.f))
        refuse("the field of view is not between 0 and 180 degrees", "40 is a good start");
    if (!(aspect > 0.f) || std::isinf(aspect))
        refuse("the aspect ratio is not positive", "give a size of at least 1x1");

    const glm::dvec3 view = glm::dvec3(camera.target) - glm::dvec3(camera.position);
    const double distance = glm::length(view);
    if (!(distance > 0.0)) refuse("it stands where it looks at", "move the position or the target");
    const glm::dvec3 forward = view / distance;
    const glm::dvec3 sideways = glm::cross(forward, glm::dvec3(camera.up));
    if (!(glm::length(sideways) > 1e-6 * glm::length(glm::dvec3(camera.up))))
        refuse("it looks along its up vector", "choose another up, such as 0,0,1");

    const double half_height = std::tan(0.5 * glm::radians(double(camera.vertical_fov)));
    const glm::dvec3 right = glm::normalize(sideways);
    const glm::vec3 f(forward), r(right * (half_height * aspect)), u(glm::cross(right, forward) * half_height);
    const glm::vec3& p = camera.position;
    return {p.x, p.y, p.z, f.x, f.y, f.z, r.x, r.y, r.z, u.x, u.y, u.z};
}

}  // namespace claray
