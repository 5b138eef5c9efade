// The Cornell box, from the measurements of the Cornell University Program of Computer Graphics
// (graphics.cornell.edu/online/box/data.html), in metres. Colours are the usual Rec. 709 fits of its spectra.
#include <array>

#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

enum : std::uint32_t { white_wall, red_wall, green_wall, ceiling_lamp };

using Rectangle = std::array<glm::vec3, 4>;

glm::vec3 millimetres(float x, float y, float z) { return 1e-3f * glm::vec3(x, y, z); }

void add_wall(Scene& scene, const char* name, const Rectangle& r, std::uint32_t material) {
    Mesh mesh = named_mesh(name);
    add_quad(mesh, r[0], r[1], r[2], r[3], material);
    scene.meshes.push_back(std::move(mesh));
}

// The ceiling is a frame round the lamp that shares the lamp's corners, so no two surfaces lie in one another.
void add_ceiling(Scene& scene, const Rectangle& ceiling, const Rectangle& opening) {
    Mesh mesh = named_mesh("ceiling");
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t next = (i + 1) % 4;
        add_quad(mesh, ceiling[i], ceiling[next], opening[next], opening[i], white_wall);
    }
    scene.meshes.push_back(std::move(mesh));
}

// A block without its bottom; `top` is counter-clockwise seen from above.
void add_block(Scene& scene, const char* name, const Rectangle& top) {
    Mesh mesh = named_mesh(name);
    add_quad(mesh, top[0], top[1], top[2], top[3], white_wall);
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 a = top[i], b = top[(i + 1) % 4];
        add_quad(mesh, b, a, {a.x, 0.f, a.z}, {b.x, 0.f, b.z}, white_wall);
    }
    scene.meshes.push_back(std::move(mesh));
}

}  // namespace

Scene cornell() {
    Scene scene;
    scene.materials = {lambert("white", {0.725f, 0.71f, 0.68f}), lambert("red", {0.63f, 0.065f, 0.05f}),
                       lambert("green", {0.14f, 0.45f, 0.091f}), lamp("light", {17.f, 12.f, 4.f})};
    const Rectangle floor = {millimetres(552.8f, 0, 0), millimetres(0, 0, 0), millimetres(0, 0, 559.2f),
                             millimetres(549.6f, 0, 559.2f)};
    const Rectangle ceiling = {millimetres(556, 548.8f, 0), millimetres(556, 548.8f, 559.2f),
                               millimetres(0, 548.8f, 559.2f), millimetres(0, 548.8f, 0)};
    const Rectangle panel = {millimetres(343, 548.8f, 227), millimetres(343, 548.8f, 332),
                             millimetres(213, 548.8f, 332), millimetres(213, 548.8f, 227)};
    add_wall(scene, "floor", floor, white_wall);
    add_ceiling(scene, ceiling, panel);
    add_wall(scene, "lamp", panel, ceiling_lamp);
    add_wall(scene, "back wall", {floor[3], floor[2], ceiling[2], ceiling[1]}, white_wall);
    add_wall(scene, "right wall", {floor[2], floor[1], ceiling[3], ceiling[2]}, green_wall);
    add_wall(scene, "left wall", {floor[0], floor[3], ceiling[1], ceiling[0]}, red_wall);
    add_block(
        scene, "short block",
        {millimetres(130, 165, 65), millimetres(82, 165, 225), millimetres(240, 165, 272), millimetres(290, 165, 114)});
    add_block(scene, "tall block",
              {millimetres(423, 330, 247), millimetres(265, 330, 296), millimetres(314, 330, 456),
               millimetres(472, 330, 406)});

    // Focal length 35 mm, film 25 mm: 2 * atan(12.5 / 35) = 39.3 degrees.
    scene.camera = Camera{millimetres(278, 273, -800), millimetres(278, 273, 0), {0.f, 1.f, 0.f}, 39.3077f};
    return scene;
}

}  // namespace claray::scenes
