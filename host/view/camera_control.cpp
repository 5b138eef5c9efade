#include "host/view/camera_control.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "claray/error.hpp"
#include "host/base/format.hpp"

namespace claray::view {
namespace {

constexpr double closest_to_pole = 0.0174532925199433;  // radians

struct Axes {
    glm::dvec3 forward, right, up;
    double distance;
};

Axes axes_of(const Camera& camera) {
    const glm::dvec3 way = glm::dvec3(camera.target) - glm::dvec3(camera.position);
    const glm::dvec3 forward = glm::normalize(way);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));
    return {forward, right, glm::cross(right, forward), glm::length(way)};
}

glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
    return glm::dmat3(glm::rotate(glm::dmat4(1.0), angle, axis)) * v;
}

/// Turns a direction by two angles, but not across the poles.
glm::dvec3 turned(const glm::dvec3& direction, const glm::dvec3& up, double right_degrees, double up_degrees) {
    const glm::dvec3 pole = glm::normalize(up);
    const double now = std::acos(std::clamp(glm::dot(direction, pole), -1.0, 1.0));
    const double then = std::clamp(now - glm::radians(up_degrees), closest_to_pole, 3.14159265358979 - closest_to_pole);
    const glm::dvec3 side = glm::normalize(glm::cross(direction, pole));
    return rotated(rotated(direction, side, now - then), pole, -glm::radians(right_degrees));
}

Camera shifted(Camera camera, const glm::dvec3& by) {
    camera.position = glm::vec3(glm::dvec3(camera.position) + by);
    camera.target = glm::vec3(glm::dvec3(camera.target) + by);
    return camera;
}

}  // namespace

Camera orbit(const Camera& camera, float right_degrees, float up_degrees) {
    const Axes axes = axes_of(camera);
    Camera result = camera;
    const glm::dvec3 back = turned(-axes.forward, camera.up, -right_degrees, up_degrees);
    result.position = glm::vec3(glm::dvec3(camera.target) + axes.distance * back);
    return result;
}

Camera turn(const Camera& camera, float right_degrees, float up_degrees) {
    const Axes axes = axes_of(camera);
    Camera result = camera;
    const glm::dvec3 forward = turned(axes.forward, camera.up, right_degrees, up_degrees);
    result.target = glm::vec3(glm::dvec3(camera.position) + axes.distance * forward);
    return result;
}

glm::vec3 along_image(const Camera& camera, const glm::vec3& point, float right, float up) {
    const Axes axes = axes_of(camera);
    const double distance = glm::dot(glm::dvec3(point) - glm::dvec3(camera.position), axes.forward);
    const double height = camera.orthographic_height > 0
                              ? camera.orthographic_height
                              : 2 * distance * std::tan(0.5 * glm::radians(double(camera.vertical_fov)));
    return glm::vec3(height * (double(right) * axes.right + double(up) * axes.up));
}

Camera pan(const Camera& camera, float right, float up) {
    return shifted(camera, along_image(camera, camera.target, right, up));
}

Camera fly(const Camera& camera, float forward, float right, float up) {
    const Axes axes = axes_of(camera);
    return shifted(camera, double(forward) * axes.forward + double(right) * axes.right + double(up) * axes.up);
}

Camera zoom(const Camera& camera, float factor) {
    if (!(factor > 0)) throw Error(ErrorKind::user, "zoom: the factor must be greater than 0", "use for example 1.1");
    Camera result = camera;
    if (camera.orthographic_height > 0) {
        result.orthographic_height /= factor;
        if (result.orthographic_height == 0)  // which would mean a perspective camera
            throw Error(ErrorKind::user, "zoom: the height of the image becomes 0", "use a smaller factor");
        return result;
    }
    const Axes axes = axes_of(camera);
    result.position = glm::vec3(glm::dvec3(camera.target) - axes.distance / factor * axes.forward);
    return result;
}

namespace {

/// From the middle of the image to the centre of a pixel, in the plane at distance 1 (orthographic: any).
glm::vec3 across(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height) {
    const float right = 2.f * (float(x) + 0.5f) / float(width) - 1.f,
                up = 1.f - 2.f * (float(y) + 0.5f) / float(height);
    return right * glm::vec3(camera.right_x, camera.right_y, camera.right_z) +
           up * glm::vec3(camera.up_x, camera.up_y, camera.up_z);
}

}  // namespace

glm::vec3 direction_through(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height) {
    const glm::vec3 forward(camera.forward_x, camera.forward_y, camera.forward_z);
    return glm::normalize(camera.orthographic != 0 ? forward : forward + across(camera, x, y, width, height));
}

glm::vec3 point_through(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height,
                        float distance) {
    glm::vec3 origin(camera.x, camera.y, camera.z);
    if (camera.orthographic != 0) origin += across(camera, x, y, width, height);
    return origin + distance * direction_through(camera, x, y, width, height);
}

std::string options_of(const Camera& camera) {
    const auto triple = [](const char* name, const glm::vec3& v) {
        return printed("%s %.9g,%.9g,%.9g ", name, double(v.x), double(v.y), double(v.z));
    };
    std::string options = triple("--camera", camera.position) + triple("--look-at", camera.target);
    if (camera.up != glm::vec3(0, 1, 0)) options += triple("--up", camera.up);
    options += camera.orthographic_height > 0 ? printed("--ortho %.9g", double(camera.orthographic_height))
                                              : printed("--fov %.9g", double(camera.vertical_fov));
    if (camera.aperture_radius > 0) options += printed(" --aperture %.9g", double(camera.aperture_radius));
    if (camera.aperture_radius > 0 && camera.focus_distance > 0)
        options += printed(" --focus-distance %.9g", double(camera.focus_distance));
    return options;
}

}  // namespace claray::view
