// Closed fans: triangles round one shared vertex, slightly domed towards +z, with rims that are not quite round. Rays
// at the shared edges and vertices show whether an intersection test leaks.
#include <cmath>
#include <numbers>

#include "host/base/random.hpp"
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

// Beyond this many the steps along the rim come close to the spacing of floats; more triangles make more fans.
constexpr std::size_t most_a_fan = 65536;
constexpr std::uint32_t colors = 6;

void add_fan(Mesh& mesh, const glm::vec3& center, std::size_t count, Random& random) {
    const auto apex = std::uint32_t(mesh.positions.size());
    mesh.positions.push_back(center + glm::vec3(0.f, 0.f, 0.25f));
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * (double(i) + 0.5 * random.uniform()) / double(count);
        const double radius = 1.0 - 0.04 * random.uniform();
        mesh.positions.push_back(center + glm::vec3(radius * std::cos(angle), radius * std::sin(angle), 0.0));
        const auto here = std::uint32_t(apex + 1 + i), next = std::uint32_t(apex + 1 + (i + 1) % count);
        mesh.triangles.emplace_back(apex, here, next);
        // Colours in turn, and none twice side by side where the rim closes.
        mesh.materials.push_back(i + 1 == count && i % colors == 0 ? 1 : std::uint32_t(i % colors));
    }
}

}  // namespace

Scene fan(std::size_t count) {
    Scene scene;
    scene.materials = {lambert("red", {0.7f, 0.16f, 0.12f}),  lambert("sand", {0.75f, 0.62f, 0.4f}),
                       lambert("blue", {0.12f, 0.28f, 0.6f}), lambert("white", {0.8f, 0.79f, 0.76f}),
                       lambert("green", {0.2f, 0.45f, 0.2f}), lambert("grey", {0.35f, 0.35f, 0.37f})};
    const std::size_t fans = (count + most_a_fan - 1) / most_a_fan;
    const auto columns = std::size_t(std::ceil(std::sqrt(double(fans)))), rows = (fans + columns - 1) / columns;
    Mesh mesh = named_mesh("fan", count + fans, count);
    Random random(31);
    for (std::size_t i = 0; i < fans; ++i) {
        const std::size_t column = i % columns, row = i / columns;
        const float x = 2.1f * (float(column) - 0.5f * float(columns - 1));
        const float y = 2.1f * (0.5f * float(rows - 1) - float(row));
        add_fan(mesh, {x, y, 0.f}, count * (i + 1) / fans - count * i / fans, random);
    }
    scene.meshes.push_back(std::move(mesh));
    scene.sky = {{0.35f, 0.37f, 0.4f}, {1.1f, 1.1f, 1.1f}};
    const float extent = 1.05f * float(columns);
    scene.camera = Camera{extent * glm::vec3(0.9f, 0.7f, 3.2f), glm::vec3(0.f), {0.f, 1.f, 0.f}, 38.f};
    return scene;
}

}  // namespace claray::scenes
