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
        constexpr double soft = 0.12;
        const glm::dvec2 inside = 1.0 - glm::smoothstep(half - soft, half + soft, glm::abs(at));
        return radiance * inside.x * inside.y;
    }
};

const Panel panels[] = {
    {{-0.65, 0.62, 0.75}, {0.42, 0.36}, 6.0},   // key
    {{0.95, 0.25, 0.45}, {0.22, 0.5}, 1.6},     // fill
    {{0.0, 1.0, -0.15}, {0.5, 0.4}, 3.0},       // overhead
    {{-0.95, 0.25, -0.62}, {0.16, 0.55}, 3.0},  // rims
    {{0.95, 0.3, -0.62}, {0.16, 0.55}, 4.0},
};

/// The room is lighter at its ceiling.
double radiance_along(const glm::dvec3& direction) {
    double sum = 0.15 + 0.08 * direction.y;
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
