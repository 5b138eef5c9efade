// Rolling hills round a lake that mirrors them, with firs of a few triangles each.
#include <cmath>

#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/noise.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

enum : std::uint32_t { meadow, dry_grass, sand, water, trunk, fir, young_fir, sun };

constexpr float hills_half_size = 60.f;
constexpr float water_level = 0.f;
constexpr unsigned columns = 240;

// Hills that rise away from a basin in the middle.
double height_of_hills(double x, double z) {
    const double distance = std::sqrt(x * x + 1.6 * z * z) / hills_half_size;
    const double basin = 9.0 * std::min(distance * distance, 1.2) - 1.6;
    return basin + 3.4 * fractal_noise(x / 21.0, z / 21.0, 4, 3, 0.42) * (0.35 + std::min(distance, 1.0));
}

double slope(double x, double z) {
    const double step = 0.25;
    const double dx = height_of_hills(x + step, z) - height_of_hills(x - step, z),
                 dz = height_of_hills(x, z + step) - height_of_hills(x, z - step);
    return std::sqrt(dx * dx + dz * dz) / (2.0 * step);
}

Mesh make_meadows() {
    Mesh mesh = make_height_field(columns, hills_half_size, height_of_hills);
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 p = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.f;
        const double patches = fractal_noise(p.x / 7.0, p.z / 7.0, 3, 17);
        mesh.materials.push_back(p.y < water_level + 0.35f ? sand : patches > 0.25 ? dry_grass : meadow);
    }
    return mesh;
}

void add_fir(Mesh& mesh, const glm::vec3& base, float size, std::uint32_t needles) {
    add_frustum(mesh, base - glm::vec3(0.f, 0.2f, 0.f), 0.1f * size, 0.07f * size, 0.2f + 0.5f * size, 5, trunk);
    for (int tier = 0; tier < 3; ++tier) {
        const float y = (0.4f + 0.55f * float(tier)) * size, radius = (0.62f - 0.15f * float(tier)) * size;
        add_frustum(mesh, base + glm::vec3(0.f, y, 0.f), radius, 0.f, 1.05f * size, 7, needles);
    }
}

// Firs stand on dry, not too steep ground, in woods rather than evenly.
Mesh make_firs(unsigned tries) {
    Mesh mesh = named_mesh("firs");
    Random random(11);
    for (unsigned i = 0; i < tries; ++i) {
        const float x = random.uniform(-0.97f, 0.97f) * hills_half_size,
                    z = random.uniform(-0.97f, 0.97f) * hills_half_size;
        const float size = random.uniform(0.6f, 1.4f), y = float(height_of_hills(x, z));
        const std::uint32_t needles = random.below(3) ? fir : young_fir;
        const bool in_view = z > 36.f && std::abs(x) < 8.f;  // none right before the camera
        if (y < water_level + 0.5f || slope(x, z) > 0.55 || fractal_noise(x / 16.0, z / 16.0, 2, 29) < 0.02 || in_view)
            continue;
        add_fir(mesh, {x, y, z}, size, needles);
    }
    return mesh;
}

}  // namespace

Scene hills() {
    Scene scene;
    scene.materials = {lambert("meadow", {0.13f, 0.24f, 0.055f}),   lambert("dry grass", {0.3f, 0.29f, 0.1f}),
                       lambert("sand", {0.5f, 0.42f, 0.28f}),       mirror("water", {0.5f, 0.6f, 0.66f}),
                       lambert("trunk", {0.16f, 0.1f, 0.06f}),      lambert("fir", {0.03f, 0.1f, 0.035f}),
                       lambert("young fir", {0.06f, 0.15f, 0.03f}), lamp("sun", {420.f, 350.f, 250.f})};
    Mesh lake = named_mesh("lake");
    add_rectangle(lake, {0.f, water_level, 0.f}, {0.f, 0.f, hills_half_size}, {hills_half_size, 0.f, 0.f}, water);
    scene.meshes = {make_meadows(), std::move(lake), make_firs(5000),
                    make_lamp({-70.f, 75.f, 45.f}, {0.f, 0.f, 0.f}, 5.5f, sun)};
    scene.sky = {{0.72f, 0.74f, 0.76f}, {0.16f, 0.32f, 0.7f}};
    scene.camera = Camera{{2.f, 9.5f, 46.f}, {0.f, 2.2f, 0.f}, {0.f, 1.f, 0.f}, 42.f};
    return scene;
}

}  // namespace claray::scenes
