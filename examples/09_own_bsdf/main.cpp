// A BSDF that claray does not have, in a file of its own: dust.clh. Two moons in the light of a sun, the left one of a
// Lambertian, the right one of dust, which is as bright at its edge as in its middle when the sun is behind the viewer.
//     example_09_own_bsdf [PICTURE [SPP]]
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace {

std::string read_beside_this_file(const char* name) {
    std::ifstream file(std::filesystem::path(__FILE__).parent_path() / name);
    if (!file) throw claray::Error(claray::ErrorKind::user, std::string("cannot read ") + name);
    return {std::istreambuf_iterator<char>(file), {}};
}

claray::MeshInstance placed(std::uint32_t mesh, const glm::vec3& at) {
    claray::MeshInstance instance;
    instance.mesh = mesh;
    instance.transform[3] = glm::vec4(at, 1.f);
    return instance;
}

claray::Scene two_moons(std::uint32_t dust) {
    claray::Warnings warnings;
    claray::Scene scene;
    scene.materials.resize(2);
    scene.materials[0].name = "paint";
    scene.materials[1].name = "moon dust", scene.materials[1].kind = claray::MaterialKind::custom;
    scene.materials[1].custom = dust, scene.materials[1].parameters = {-0.3f};
    claray::Mesh ball = claray::load_scene("effect:lambert", warnings).meshes[1];
    for (glm::vec3& p : ball.positions) p -= glm::vec3(-0.35f, 0.8f, 0.f);
    for (std::uint32_t material = 0; material < 2; ++material) {
        ball.materials.assign(ball.triangles.size(), material);
        scene.meshes.push_back(ball);
        scene.instances.push_back(placed(material, {material == 0 ? -0.9f : 0.9f, 0.f, 0.f}));
    }
    claray::Light sun;
    sun.kind = claray::LightKind::sun, sun.direction = {0.3f, -0.2f, -1.f}, sun.outer_angle = 0.0046f;
    sun.intensity = glm::vec3(3.f);
    scene.lights = {sun};
    scene.camera = claray::Camera{.position = {0.f, 0.f, 6.f}, .vertical_fov = 20.f};
    return scene;
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string picture = argc > 1 ? argv[1] : "moons.png";
    const auto spp = unsigned(argc > 2 ? std::atoi(argv[2]) : 64);
    const std::uint32_t dust =
        claray::add_bsdf({.name = "dust", .source = read_beside_this_file("dust.clh"), .parameters = 1});
    const claray::Scene scene = two_moons(dust);
    for (const claray::EffectCause& cause : claray::causes_of_effects(scene))
        std::printf("%s: %s\n", claray::name_of(cause.effect), cause.first.c_str());

    claray::Renderer renderer(claray::Device::open(), scene, {.width = 480, .height = 240, .spp = spp});
    renderer.render();
    claray::write_image(picture, {480, 240, renderer.image()});
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
