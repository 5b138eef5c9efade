// What the tests of the view look at.
#pragma once

#include <string>
#include <vector>

#include "host/view/view.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {

/// Two spheres of one mesh above a floor.
inline Scene two_spheres() {
    Scene scene;
    scene.materials.resize(2);
    scene.materials[1].name = "red", scene.materials[1].albedo = {0.8f, 0.1f, 0.1f};
    Mesh floor, ball = sphere(2);
    floor.positions = {{-9, -1, -9}, {-9, -1, 9}, {9, -1, 9}, {9, -1, -9}}, floor.triangles = {{0, 1, 2}, {0, 2, 3}};
    ball.name = "ball", ball.materials.assign(ball.triangles.size(), 1);
    scene.meshes = {floor, ball};
    scene.instances = {{0}, {1}, {1}};
    scene.instances[1].transform[3].x = -2, scene.instances[2].transform[3].x = 2;
    scene.lights = {point_light({0, 4, 3}, glm::vec3(30))};
    scene.camera = Camera{{0, 1, 8}, {0, 0, 0}, {0, 1, 0}, 45.f};
    return scene;
}

inline const view::ViewConfig small_view{
    .render = {.width = 24, .height = 16, .spp = 4, .max_depth = 4}, .answer_seconds = 0, .picture = {}};

inline std::vector<std::uint8_t> rendered(const Scene& scene, const RenderConfig& render = small_view.render) {
    Renderer renderer(device(), scene, render);
    (void)renderer.render();
    const auto picture = renderer.picture();
    return {picture.begin(), picture.end()};
}

inline std::string run(view::View& view, const std::string& line) { return view.run(view::parse_command(line)); }

}  // namespace claray::test
