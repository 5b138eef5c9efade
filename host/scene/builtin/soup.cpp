// N random triangles in the unit cube: no order, no neighbours, the hardest input for a hierarchy of boxes.
#include <algorithm>
#include <cmath>

#include "host/base/random.hpp"
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {

Scene soup(std::size_t count) {
    Scene scene;
    scene.materials = {lambert("red", {0.72f, 0.13f, 0.1f}),  lambert("orange", {0.8f, 0.42f, 0.08f}),
                       lambert("yellow", {0.8f, 0.7f, 0.2f}), lambert("teal", {0.08f, 0.45f, 0.42f}),
                       lambert("blue", {0.1f, 0.22f, 0.6f}),  lambert("white", {0.8f, 0.8f, 0.78f})};
    Mesh mesh = named_mesh("soup", 3 * count, count);
    Random random(114);
    // About as large as their mean distance: the eye reaches a few layers deep, whatever N.
    const auto size = float(std::min(0.45, 0.9 / std::cbrt(double(count))));
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 center = glm::vec3(0.5f) + (0.5f - size) * random.in_cube();
        const glm::vec3 a = center + size * random.in_cube(), b = center + size * random.in_cube();
        const glm::vec3 c = center + size * random.in_cube();
        add_triangle(mesh, a, b, c, random.below(std::uint32_t(scene.materials.size())));
    }
    scene.meshes.push_back(std::move(mesh));
    scene.lights = {point_light({-1.f, 3.f, 3.f}, {26.f, 24.f, 21.f})};
    scene.sky = {{0.7f, 0.74f, 0.8f}, {0.35f, 0.5f, 0.8f}};
    scene.camera = Camera{{1.75f, 1.45f, 2.6f}, {0.5f, 0.47f, 0.5f}, {0.f, 1.f, 0.f}, 34.f};
    return scene;
}

}  // namespace claray::scenes
