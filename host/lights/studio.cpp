#include "host/lights/studio.hpp"

#include <cmath>
#include <numbers>

namespace claray {
namespace {

/// A rectangle at distance 1 that faces the middle of the room. Its light fades at its borders.
struct Panel {
    glm::dvec3 place;  // its direction from the middle: to the right, upwards, towards the camera
    glm::dvec2 half;   // of its width and of its height
    double radiance;

    [[nodiscard]] double seen_along(const glm::dvec3& direction) const {
        const glm::dvec3 axis = glm::normalize(place);
        const double depth = glm::dot(direction, axis);
        if (depth <= 0) return 0;
        const glm::dvec3 up_hint = std::abs(axis.y) > 0.9 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
        const glm::dvec3 right = glm::normalize(glm::cross(up_hint, axis)), up = glm::cross(axis, right);
        const glm::dvec2 at = glm::dvec2(glm::dot(direction, right), glm::dot(direction, up)) / depth;
        const glm::dvec2 soft(0.3 * half.x);
        const glm::dvec2 inside = 1.0 - glm::smoothstep(half - soft, half + soft, glm::abs(at));
        return radiance * inside.x * inside.y;
    }
};

const Panel panels[] = {
    {{-0.72, 0.3, 0.66}, {0.42, 0.55}, 3.7},  // key
    {{0.9, 0.1, 0.5}, {0.2, 0.6}, 1.2},       // fill
    {{0.0, 1.0, -0.1}, {0.5, 0.45}, 2.5},     // overhead
    {{-0.82, 0.2, -0.57}, {0.15, 0.6}, 2.5},  // rims
    {{0.79, 0.05, -0.62}, {0.16, 0.48}, 3.2},
};

/// The wall behind the object is lighter than what is behind the camera, and lightens above the camera's view. Boxes of
/// metal show the difference.
double radiance_along(const glm::dvec3& direction) {
    const double behind_camera = glm::smoothstep(-0.2, 0.5, direction.z);
    double sum = glm::mix(0.16, 0.05, behind_camera) + 0.35 * glm::smoothstep(0.1, 0.7, direction.y);
    sum -= 0.08 * (1 - behind_camera) * glm::smoothstep(0.6, 0.9, -direction.y);
    for (const Panel& panel : panels) sum += panel.seen_along(direction);
    return sum;
}

}  // namespace

Environment studio(const Camera& camera) {
    const glm::dvec3 up = glm::normalize(glm::dvec3(camera.up));
    const glm::dvec3 view = glm::dvec3(camera.target) - glm::dvec3(camera.position);
    const glm::dvec3 right = glm::normalize(glm::cross(view, up)), back = glm::cross(right, up);
    Texture image;
    image.name = "studio";
    image.format = TexelFormat::float32;
    image.width = 256, image.height = 128, image.channels = 1;
    for (unsigned y = 0; y < image.height; ++y)
        for (unsigned x = 0; x < image.width; ++x) {
            const double across = 2 * std::numbers::pi * ((x + 0.5) / image.width - 0.5);
            const double down = std::numbers::pi * (y + 0.5) / image.height;
            const glm::dvec3 d(std::sin(down) * std::sin(across), std::cos(down), -std::sin(down) * std::cos(across));
            image.floats.push_back(float(radiance_along({glm::dot(d, right), glm::dot(d, up), glm::dot(d, back)})));
        }
    Environment environment;
    environment.images.push_back(std::move(image));
    return environment;
}

}  // namespace claray
