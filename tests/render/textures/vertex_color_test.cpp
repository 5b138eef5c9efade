// Colours at vertices: against interpolation in float64 and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/renderer.hpp"
#include "host/render/checkpoint/scene_digest.hpp"
#include "host/textures/textures.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

/// A triangle in y = 0 whose front is up, white but for its colours.
Scene painted_triangle() {
    Scene scene;
    scene.materials = {lambert(1.f)};
    Mesh mesh;
    mesh.positions = {{-1, 0, 1}, {1, 0, 1}, {-1, 0, -1}};
    mesh.triangles = {{0, 1, 2}};
    mesh.colors = {{1, 0, 0.25f, 1}, {0, 0.5f, 0.75f, 1}, {0.125f, 1, 0, 1}};
    scene.meshes = {mesh};
    return scene;
}

/// The colour at x, z of that triangle.
glm::dvec3 painted(double x, double z) {
    const double u = (x + 1) / 2, v = (1 - z) / 2;
    return (1 - u - v) * glm::dvec3(1, 0, 0.25) + u * glm::dvec3(0, 0.5, 0.75) + v * glm::dvec3(0.125, 1, 0);
}

/// What a camera sees of one point, by one light straight above that gives white Lambertians the radiance 1.
glm::dvec3 seen_color(Scene scene, double x, double z) {
    scene.lights = {point_light({0, 1000, 0}, glm::vec3(float(1e6 * std::numbers::pi)))};
    scene.camera = narrow_camera({float(x) + 1, 2, float(z)}, {float(x), 0, float(z)});
    return mean(render_image(scene, {.width = 1, .height = 1, .spp = 4, .max_depth = 1}));
}

void expect_colors(const Scene& scene) {
    for (const auto& [x, z] :
         {std::pair(-0.9, 0.8), std::pair(-0.5, 0.1), std::pair(0.5, 0.9), std::pair(-0.8, -0.7)}) {
        const glm::dvec3 color = seen_color(scene, x, z), expected = painted(x, z);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(color[k], expected[k], 1e-4) << x << ", " << z;
    }
}

TEST(VertexColors, AreInterpolated) { expect_colors(painted_triangle()); }

TEST(VertexColors, OfInstancesToo) {
    Scene scene = painted_triangle();
    scene.instances = {{0, glm::mat4(1.f), {}}, {0, glm::mat4(1.f), {}}};
    scene.instances[1].transform[3].x = 5.f;
    expect_colors(scene);
}

TEST(VertexColors, OfOneMeshLeaveOthersWhite) {
    Scene scene = painted_triangle();
    scene.meshes.insert(scene.meshes.begin(), square(1.f, 0.f));
    for (glm::vec3& p : scene.meshes[0].positions) p.x += 3.f;
    expect_colors(scene);
    EXPECT_NEAR(seen_color(scene, 3.2, 0.1).y, 1, 1e-4);
}

/// Next to an image: they multiply.
TEST(VertexColors, MultiplyTextures) {
    Scene scene = painted_triangle();
    scene.textures = {float_texture({1, 1}, [](double, double) { return glm::vec3(0.5f, 0.25f, 1.f); })};
    scene.materials[0].albedo_map.texture = 0;
    scene.materials[0].albedo = {1.f, 0.5f, 0.25f};
    scene.meshes[0].uvs.assign(3, glm::vec2(0.5f));
    const glm::dvec3 color = seen_color(scene, -0.5, 0.1), expected = painted(-0.5, 0.1) * glm::dvec3(0.5, 0.125, 0.25);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(color[k], expected[k], 1e-4);
}

TEST(VertexColors, AreInTheAlbedoImage) {
    Scene scene = painted_triangle();
    scene.camera = narrow_camera({0.5f, 2, 0.1f}, {-0.5f, 0, 0.1f});
    Renderer renderer(device(), scene, {.width = 1, .height = 1});
    const glm::vec3 albedo = renderer.aovs().albedo.at(0);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(double(albedo[k]), painted(-0.5, 0.1)[k], 1e-4);
}

/// A light map holds irradiance: colours of other surfaces affect it, those of the mesh itself do not.
TEST(VertexColors, OfTheBakedMeshDoNotCount) {
    Scene scene;
    scene.materials = {lambert_material()};
    scene.meshes = {mapped_square()};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    const LightMapConfig config{.width = 4, .height = 4, .spp = 16, .uv_set = 0};
    const Texture white = bake_light_map(device(), scene, 0, config);
    scene.meshes[0].colors.assign(4, glm::vec4(0.5f, 0.5f, 0.5f, 1.f));
    EXPECT_EQ(bake_light_map(device(), scene, 0, config).floats, white.floats);
}

/// A ramp of alpha from 0 to 1 over a black square in front of a white sky.
Scene ramp(AlphaMode mode) {
    Scene scene;
    scene.materials = {lambert(0.f)};
    scene.materials[0].alpha_mode = mode;
    scene.meshes = {square(1.f, 0.f)};
    for (const glm::vec3& p : scene.meshes[0].positions)
        scene.meshes[0].colors.emplace_back(1, 1, 1, 0.5f + 0.5f * p.x);
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}, float(2 * std::atan(0.1) * 180 / std::numbers::pi)};
    return scene;
}

TEST(VertexColors, TheirAlphaIsAnOpacity) {
    const auto covered = [](const Scene& scene) {
        return 1 - mean(render_image(scene, {.width = 64, .height = 64, .spp = 64})).x;
    };
    Scene scene = ramp(AlphaMode::mask);
    scene.materials[0].alpha_cutoff = 0.3f;
    EXPECT_NEAR(covered(scene), 0.7, 0.002);
    EXPECT_NEAR(covered(ramp(AlphaMode::blend)), 0.5, 0.003);
    EXPECT_NEAR(covered(ramp(AlphaMode::opaque)), 1, 1e-6);
}

/// In device memory: three floats per vertex, and nothing if all is white.
TEST(VertexColors, TakeMemoryOnlyWhereTheyAre) {
    Scene scene = painted_triangle();
    EXPECT_TRUE(Textures(device(), scene).store.allocated());
    scene.meshes[0].colors.assign(3, glm::vec4(1.f));
    EXPECT_FALSE(Textures(device(), scene).store.allocated());
    EXPECT_FALSE(effects_of(scene).has(Effect::vertex_colors));
}

TEST(VertexColors, AreValidatedAndDigested) {
    Scene scene = painted_triangle();
    EXPECT_NO_THROW(validate(scene));
    const Digest before = digest_of(scene);
    scene.meshes[0].colors[1].y = 0.6f;
    EXPECT_NE(digest_of(scene), before);
    scene.meshes[0].colors[1].y = 1.5f;
    EXPECT_TRUE(throws_error(ErrorKind::user, "colour of vertex 1", [&] { validate(scene); }));
    scene.meshes[0].colors[1].y = NAN;
    EXPECT_TRUE(throws_error(ErrorKind::user, "colour of vertex 1", [&] { validate(scene); }));
    scene.meshes[0].colors.resize(2);
    EXPECT_TRUE(throws_error(ErrorKind::user, "2 colours for 3 vertices", [&] { validate(scene); }));
}

}  // namespace
}  // namespace claray::test
