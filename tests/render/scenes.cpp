#include "tests/render/scenes.hpp"

#include <cmath>
#include <cstring>

#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {

Material material(MaterialKind kind, float albedo, float roughness) {
    Material m;
    m.kind = kind;
    m.albedo = glm::vec3(albedo);
    m.roughness = roughness;
    return m;
}

Material lambert(float albedo) { return material(MaterialKind::lambert, albedo); }

Material emitter(float radiance) {
    Material m = lambert(0.f);
    m.emission = glm::vec3(radiance);
    return m;
}

Mesh square(float half, float y, std::uint32_t material) {
    Mesh mesh;
    mesh.positions = {{-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials = {material, material};
    return mesh;
}

Camera narrow_camera(glm::vec3 position, glm::vec3 target) {
    Camera camera;
    camera.position = position;
    camera.target = target;
    camera.vertical_fov = 0.01f;
    const glm::vec3 view = glm::abs(target - position);
    if (view.y > 0.9f * glm::length(view)) camera.up = {0.f, 0.f, 1.f};
    return camera;
}

Scene among_lamps(const Material& material) {
    Scene scene;
    scene.materials = {material, emitter(1.f)};
    Mesh lamps = sphere(2, 4.f, {0.7f, 0.2f, 0.f});
    lamps.materials.assign(lamps.triangles.size(), 1);
    scene.meshes = {square(0.5f, 0.f), lamps};
    scene.camera = narrow_camera({0, 1.2f, 1}, {0, 0, 0});
    return scene;
}

glm::dvec3 mean(const std::vector<glm::vec3>& image) {
    glm::dvec3 sum(0.0);
    for (const glm::vec3& pixel : image) sum += glm::dvec3(pixel);
    return sum / double(image.size());
}

std::vector<double> column_means(const std::vector<glm::vec3>& image, unsigned width) {
    std::vector<double> means(width);
    for (std::size_t i = 0; i < image.size(); ++i) means[i % width] += image[i].x * width / double(image.size());
    return means;
}

double schlick(double f0, double cosine) { return f0 + (1 - f0) * std::pow(1 - cosine, 5); }

bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

std::vector<glm::vec3> render_image(const Scene& scene, RenderConfig config) {
    if (!config.effects.any()) config.effects.add = full_effects();
    return render_by_own_kernels(scene, config);
}

namespace {

std::vector<glm::vec3> rendered_on(const Device& device, const Scene& scene, const RenderConfig& config) {
    Renderer renderer(device, scene, config);
    renderer.render();
    return renderer.image();
}

}  // namespace

std::vector<glm::vec3> render_by_own_kernels(const Scene& scene, const RenderConfig& config) {
    return rendered_on(device(), scene, config);
}

std::vector<glm::vec3> render_by_techniques(unsigned techniques, const Scene& scene, const RenderConfig& config) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.set_tuning("render/shade_surface", "TECHNIQUES", techniques);
    return rendered_on(fresh, scene, config);
}

}  // namespace claray::test
