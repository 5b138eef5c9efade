#include "host/view/camera_control.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/scene/camera.hpp"

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
    const double height = traits_of(camera.projection)->parallel
                              ? double(camera.orthographic_height)
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
    if (traits_of(camera.projection)->parallel) {
        result.orthographic_height /= factor;
        if (result.orthographic_height == 0)
            throw Error(ErrorKind::user, "zoom: the height of the image becomes 0", "use a smaller factor");
        return result;
    }
    const Axes axes = axes_of(camera);
    result.position = glm::vec3(glm::dvec3(camera.target) - axes.distance / factor * axes.forward);
    return result;
}

namespace {

CameraRay ray_through(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height) {
    return camera_ray(camera, 2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height);
}

}  // namespace

glm::vec3 direction_through(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height) {
    return glm::vec3(glm::normalize(ray_through(camera, x, y, width, height).direction));
}

glm::vec3 point_through(const CameraData& camera, unsigned x, unsigned y, unsigned width, unsigned height,
                        float distance) {
    const CameraRay ray = ray_through(camera, x, y, width, height);
    return glm::vec3(ray.origin + double(distance) * glm::normalize(ray.direction));
}

std::string options_of(const Camera& camera) {
    const auto triple = [](const char* name, const glm::vec3& v) {
        return printed("%s %.9g,%.9g,%.9g ", name, double(v.x), double(v.y), double(v.z));
    };
    std::string options = triple("--camera", camera.position) + triple("--look-at", camera.target);
    if (camera.up != glm::vec3(0, 1, 0)) options += triple("--up", camera.up);
    const ProjectionTraits& traits = *traits_of(camera.projection);
    options += traits.parallel ? printed("--ortho %.9g", double(camera.orthographic_height))
               : traits.flat   ? printed("--fov %.9g", double(camera.vertical_fov))
                               : printed("--projection %s", traits.name);
    const bool is_fisheye = camera.projection == Projection::fisheye || camera.projection == Projection::equisolid;
    if (is_fisheye) options += printed(" --fov %.9g", double(camera.vertical_fov));
    const auto pair = [&](const char* name, const glm::vec2& v) {
        if (v != glm::vec2(0.f)) options += printed(" %s %.9g,%.9g", name, double(v.x), double(v.y));
    };
    pair("--shift", camera.shift), pair("--tilt", camera.tilt);
    if (camera.stereo != Stereo::none)
        options +=
            printed(" --stereo %s --eye-distance %.9g",
                    camera.stereo == Stereo::side_by_side ? "side-by-side" : "top-bottom", double(camera.eye_distance));
    if (camera.aperture_radius > 0) options += printed(" --aperture %.9g", double(camera.aperture_radius));
    if (camera.aperture_radius > 0 && camera.focus_distance > 0)
        options += printed(" --focus-distance %.9g", double(camera.focus_distance));
    return options;
}

}  // namespace claray::view
