// Fractal mountains and, at their feet, bushes of loose triangles: N triangles in all, for measuring. Four fifths are
// an even grid; the rest lie in small dense clusters, as leaves do in real scenes.
#include <algorithm>
#include <cmath>

#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/noise.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

enum : std::uint32_t { grass, rock, snow, leaf, bright_leaf };

constexpr float terrain_half_size = 50.f;
constexpr std::size_t leaves_a_bush = 64;

// Squaring makes valleys wide and peaks steep; the land sinks towards the camera. The fractal sum lies within +-1.8.
double height_of_terrain(double x, double z) {
    const double h = 0.5 + fractal_noise(x / 38.0 + 7.3, z / 38.0 + 2.1, 10, 5, 0.44) / 1.8;
    return 52.0 * h * h * (0.58 - 0.42 * z / terrain_half_size);
}

unsigned grid_columns(std::size_t count) {
    if (count < 2) return 0;
    return std::max(1u, unsigned(std::sqrt(0.4 * double(count))));
}

Mesh make_mountains(unsigned columns) {
    Mesh mesh = make_height_field(columns, terrain_half_size, height_of_terrain);
    mesh.materials.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
        const glm::vec3 normal = glm::cross(b - a, c - a);
        const bool steep = normal.y * normal.y < 0.4f * glm::dot(normal, normal);
        mesh.materials.push_back(a.y > 21.f && !steep ? snow : steep || a.y > 14.f ? rock : grass);
    }
    return mesh;
}

// A place on the ground where bushes grow, if there is one within a few tries.
glm::vec3 find_place(Random& random) {
    glm::vec3 place(0.f);
    for (int attempt = 0; attempt < 16; ++attempt) {
        place.x = random.uniform(-0.98f, 0.98f) * terrain_half_size;
        place.z = random.uniform(-0.98f, 0.98f) * terrain_half_size;
        place.y = float(height_of_terrain(place.x, place.z));
        if (place.y < 10.f) break;
    }
    return place;
}

void add_leaf(Mesh& mesh, const glm::vec3& bush, float radius, std::uint32_t material, Random& random) {
    const glm::vec3 center = bush + radius * random.in_ball();
    const glm::vec3 u = 0.3f * radius * random.in_cube(), v = 0.3f * radius * random.in_cube();
    add_triangle(mesh, center - u, center + u, center + v, material);
}

Mesh make_bushes(std::size_t leaves) {
    Mesh mesh = named_mesh("bushes", 3 * leaves, leaves);
    Random random(24);
    // The more bushes, the smaller, so that they never cover the ground.
    const double bushes = std::ceil(double(leaves) / double(leaves_a_bush));
    const float largest = std::clamp(float(30.0 / std::sqrt(std::max(bushes, 1.0))), 0.02f, 2.f);
    for (std::size_t done = 0; done < leaves;) {
        const float radius = largest * random.uniform(0.5f, 1.f);
        const glm::vec3 bush = find_place(random) + glm::vec3(0.f, 0.6f * radius, 0.f);
        const std::uint32_t material = random.below(3) ? leaf : bright_leaf;
        for (const std::size_t end = std::min(done + leaves_a_bush, leaves); done < end; ++done)
            add_leaf(mesh, bush, radius, material, random);
    }
    return mesh;
}

}  // namespace

Scene terrain(std::size_t count) {
    Scene scene;
    scene.materials = {lambert("grass", {0.16f, 0.22f, 0.07f}), lambert("rock", {0.3f, 0.27f, 0.24f}),
                       lambert("snow", {0.85f, 0.87f, 0.9f}), lambert("leaf", {0.06f, 0.16f, 0.03f}),
                       lambert("bright leaf", {0.2f, 0.24f, 0.04f})};
    const unsigned columns = grid_columns(count);
    scene.meshes = {make_mountains(columns), make_bushes(count - 2 * std::size_t(columns) * columns)};
    scene.lights = {point_light({-160.f, 190.f, 130.f}, {2.1e5f, 1.9e5f, 1.55e5f})};
    scene.sky = {{0.72f, 0.76f, 0.8f}, {0.18f, 0.34f, 0.7f}};
    scene.camera = Camera{{0.f, 25.f, 64.f}, {0.f, 8.f, -10.f}, {0.f, 1.f, 0.f}, 42.f};
    return scene;
}

}  // namespace claray::scenes
