// The grid of light: light_grid/aim_probes.cl, light_grid/gather_probes.cl, light_grid/aim_cells.cl,
// light_grid/mark_cells.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

RenderConfig by_grid(unsigned side, unsigned spp, const LightGridConfig& grid = {}) {
    return {.width = side, .height = side, .spp = spp, .approximate = {.light_grid = true}, .light_grid = grid};
}

/// A box whose faces are seen from inside.
Mesh room(glm::vec3 lo, glm::vec3 hi, std::uint32_t material = 0) {
    Mesh mesh;
    for (unsigned i = 0; i < 8; ++i)
        mesh.positions.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
    mesh.triangles = {{0, 6, 4}, {0, 2, 6}, {1, 5, 7}, {1, 7, 3}, {0, 4, 5}, {0, 5, 1},
                      {2, 3, 7}, {2, 7, 6}, {0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}};
    mesh.materials.assign(mesh.triangles.size(), material);
    return mesh;
}

Mesh block(glm::vec3 lo, glm::vec3 hi, std::uint32_t material = 0) {
    Mesh mesh = room(lo, hi, material);
    for (glm::uvec3& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
    return mesh;
}

double error_of(const std::vector<glm::vec3>& image, const std::vector<glm::vec3>& truth) {
    double squares = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const glm::dvec3 off = glm::dvec3(image[i]) - glm::dvec3(truth[i]);
        squares += glm::dot(off, off);
    }
    const glm::dvec3 all = mean(truth);
    return std::sqrt(squares / (3 * double(image.size()))) / ((all.x + all.y + all.z) / 3);
}

TEST(LightGrid, IsThePathTracersImageOfTheCornellBox) {
    const Scene scene = *builtin_scene("cornell");
    const std::vector<glm::vec3> truth = render_by_own_kernels(scene, {.width = 64, .height = 64, .spp = 1024});
    const struct {
        LightGridConfig grid;
        double most;
    } cases[] = {{{.coefficients = 4}, 0.040}, {{}, 0.025}, {{.gather = 1}, 0.025}};
    for (const auto& [grid, most] : cases) {
        const std::vector<glm::vec3> image = render_by_own_kernels(scene, by_grid(64, 1024, grid));
        EXPECT_LT(error_of(image, truth), most) << grid.coefficients << ' ' << grid.gather;
        EXPECT_NEAR(mean(image).y / mean(truth).y, 1, 0.02) << grid.coefficients << ' ' << grid.gather;
    }
}

/// Walls that emit 1 and reflect half of what arrives shine with 1 + 1/2 + 1/4 + ... = 2.
TEST(LightGrid, KeepsTheEnergyOfAFurnace) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.materials[0].emission = glm::vec3(1.f);
    scene.meshes = {room({-1, -1, -1}, {1, 1, 1})};
    scene.camera = Camera{{0.3f, 0.2f, 0.9f}, {0, 0, 0}, {0, 1, 0}, 60.f};
    const std::vector<glm::vec3> image = render_by_own_kernels(scene, by_grid(16, 1024));
    EXPECT_NEAR(mean(image).x, 2, 0.02);
}

/// Two rooms beside each other, in halves of a box, with a wall a quarter of a cell thick between them. A lamp hangs in
/// one.
TEST(LightGrid, DoesNotLeakThroughAWall) {
    constexpr unsigned side = 16;
    const float cell = 4.f / (side - 1);
    for (const float shift : {0.f, 0.4f}) {  // of the wall against the cells
        const float at = shift * cell, half = cell / 8;
        Scene scene;
        scene.materials = {lambert(0.7f)};
        scene.meshes = {room({-2, -2, -2}, {2, 2, 2}), block({at - half, -2, -2}, {at + half, 2, 2})};
        scene.lights = {point_light({-1, 0.5f, 0}, glm::vec3(1.f))};
        const auto brightness = [&](float x) {
            scene.camera = Camera{{x, 0, 1.8f}, {x, 0, -2}, {0, 1, 0}, 60.f};
            return mean(render_by_own_kernels(scene, by_grid(16, 16, {.side = side, .rays = 32, .updates = 6}))).y;
        };
        EXPECT_LT(brightness(1.f), 0.01 * brightness(-1.f)) << shift;
    }
}

/// Black probes within a block must not darken what lies around its foot.
TEST(LightGrid, LeavesOutProbesInsideObjects) {
    Scene scene;
    scene.materials = {lambert(0.7f)};
    scene.meshes = {room({-2, -2, -2}, {2, 2, 2}), block({-1, -2, -1.1f}, {0.9f, -0.6f, 0.8f})};
    scene.lights = {point_light({0, 1.5f, 0}, glm::vec3(1.f))};
    scene.camera = Camera{{1.7f, -1, 1.7f}, {0.9f, -2, 0.8f}, {0, 1, 0}, 40.f};
    const std::vector<glm::vec3> truth = render_by_own_kernels(scene, {.width = 48, .height = 48, .spp = 1024});
    const std::vector<glm::vec3> image = render_by_own_kernels(scene, by_grid(48, 16));
    for (std::size_t i = 0; i < image.size(); ++i) EXPECT_GT(image[i].x, 0.5 * truth[i].x) << i;
}

TEST(LightGrid, FollowsALampThatIsSwitchedOff) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {room({-1, -1, -1}, {1, 1, 1})};
    scene.lights = {point_light({0, 0.5f, 0}, glm::vec3(1.f))};
    scene.camera = Camera{{0.3f, 0.2f, 0.9f}, {0, 0, 0}, {0, 1, 0}, 60.f};
    Renderer renderer(device(), scene, by_grid(16, 16, {.side = 4}));
    const double before = (renderer.render(), mean(renderer.image()).x);
    scene.lights[0].position.x = 0.9f, scene.lights[0].intensity = glm::vec3(1e-3f);
    renderer.update(scene, {.lights = true});
    for (int frame = 0; frame < 40; ++frame) {
        renderer.restart(std::uint32_t(frame));
        (void)renderer.render();
    }
    EXPECT_LT(mean(renderer.image()).x, 0.05 * before);
}

/// Levels that followed the viewer hold what levels made at its place hold.
TEST(LightGrid, LevelsFollowTheViewer) {
    Scene scene = *builtin_scene("cornell");
    const LightGridConfig grid{.side = 8, .levels = 2};
    scene.camera = camera_of(scene, 1.f);
    const auto step = [&](float x, float y) { scene.camera->position.x += x, scene.camera->position.y += y; };
    Renderer renderer(device(), scene, by_grid(32, 256, grid));
    (void)renderer.render();
    for (const auto& [x, y] : {std::pair(0.05f, 0.f), std::pair(-0.12f, 0.07f), std::pair(0.01f, -0.15f)}) {
        step(x, y);
        renderer.update(scene, {.camera = true});
        (void)renderer.render();
    }
    const std::vector<glm::vec3> followed = renderer.image();
    EXPECT_LT(error_of(followed, render_by_own_kernels(scene, by_grid(32, 256, grid))), 0.03);
}

/// A shaft whose walls hide all probes of the coarse level: only the level that follows the viewer knows its light.
/// Parallel rays show the same points of its end while the viewer comes nearer, so that only the share of that level
/// grows.
TEST(LightGrid, TakesOverFromPathsLittleByLittle) {
    constexpr unsigned side = 8, frames = 12;
    constexpr float coarse = 16 / (side - 1 + 0.1f), fine = coarse / 4;  // from one probe to the next
    constexpr float reach = side / 2.f - 1.25f, step = 0.02f;            // in fine probes
    Scene scene;
    scene.materials = {lambert(0.7f)};
    scene.meshes = {room({-8, -8, -8}, {8, 8, 8}), room({-0.9f, -0.9f, -6}, {0.9f, 0.9f, 6})};
    scene.lights = {point_light({0.4f, 0.7f, -5.5f}, glm::vec3(1.f))};
    RenderConfig config = by_grid(16, 1, {.side = side, .levels = 2});
    config.max_depth = 3;  // without Russian roulette, which ends other paths when the shares change
    std::optional<Renderer> renderer;
    std::vector<std::vector<glm::vec3>> images;
    for (unsigned i = 0; i < frames; ++i) {
        const float z = -6 + (reach + step * (3.5f - float(i))) * fine;
        scene.camera = Camera{.position = {0, 0, z},
                              .target = {0, 0, -6},
                              .projection = Projection::orthographic,
                              .orthographic_height = 1.6f};
        if (!renderer) renderer.emplace(device(), scene, config);
        renderer->update(scene, {.camera = true});
        (void)renderer->render();
        images.push_back(renderer->image());
    }
    float brightest = 0, most = 0;
    for (const glm::vec3& pixel : images[0]) brightest = std::max(brightest, pixel.x);
    for (unsigned i = 1; i < frames; ++i)
        for (std::size_t k = 0; k < images[i].size(); ++k)
            most = std::max(most, std::abs(images[i][k].x - images[i - 1][k].x));
    EXPECT_LT(most, step / reach * brightest);
    EXPECT_NE(images[0], images.back()) << "the fine level was not reached";
}

/// Sixteen hits are shaded at once, except with binary trees.
TEST(LightGrid, IsTheSameForOneLaneAndSixteen) {
    const Scene scene = *builtin_scene("cornell");
    const std::vector<glm::vec3> sixteen = render_by_own_kernels(scene, by_grid(24, 4, {.side = 4}));
    RenderConfig one = by_grid(24, 4, {.side = 4});
    one.bvh.layout = Layout::binary;
    EXPECT_LT(error_of(render_by_own_kernels(scene, one), sixteen), 1e-6);
}

/// light_grid/aim_voxels.cl, light_grid/gather_voxels.cl, light_grid/show_voxels.cl.
TEST(LightGrid, VoxelsHoldTheSurfacesOfTheScene) {
    Scene scene = *builtin_scene("cornell");
    Renderer renderer(device(), scene, by_grid(48, 64, {.voxels = true, .side = 32}));
    (void)renderer.render();
    const std::vector<glm::vec3> voxels = renderer.voxels(), albedo = renderer.aovs().albedo;
    std::vector<double> off;
    for (std::size_t i = 0; i < voxels.size(); ++i)
        off.push_back(glm::length(glm::dvec3(voxels[i]) - glm::dvec3(albedo[i])));
    std::sort(off.begin(), off.end());
    EXPECT_LT(off[off.size() * 8 / 10], 0.02) << "but where surfaces meet";
    const RenderConfig direct{.width = 48, .height = 48, .spp = 64, .max_depth = 1};
    EXPECT_GT(mean(renderer.image()).y, 1.01 * mean(render_by_own_kernels(scene, direct)).y) << "voxels are dark";
}

/// A board just above a floor that a spot lights; the spot does not shine on the board.
TEST(LightGrid, VoxelsShineAlongTheirNormals) {
    Scene scene;
    scene.materials = {lambert(0.7f)};
    scene.meshes = {square(2, 0), square(2, 0.3f), square(2, 2.1f)};
    scene.lights = {point_light({0, 0.28f, 0}, glm::vec3(1.f))};
    scene.lights[0].kind = LightKind::spot, scene.lights[0].direction = {0, -1, 0};
    scene.lights[0].inner_angle = 0.8f, scene.lights[0].outer_angle = 1.2f;
    scene.camera = Camera{{0, 0.05f, 0.4f}, {0, 0.3f, 0}, {0, 1, 0}, 20.f};
    const auto brightness = [&](const RenderConfig& config) { return mean(render_by_own_kernels(scene, config)).x; };
    const double truth = brightness({.width = 16, .height = 16, .spp = 256});
    EXPECT_GT(brightness(by_grid(16, 16, {.voxels = true, .side = 8})), 0.03 * truth);
}

/// Voxels hold what surfaces reflect, not the sky, of which a floor reflects half. Its own voxels add a little.
TEST(LightGrid, VoxelsLetTheSkyIn) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(2, 0)};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 1, 0.1f}, {0, 0, 0}, {0, 1, 0}, 40.f};
    RenderConfig config = by_grid(8, 4, {.voxels = true, .side = 4});
    const std::vector<glm::vec3> sixteen = render_by_own_kernels(scene, config);
    for (const glm::vec3& pixel : sixteen) EXPECT_NEAR(pixel.x, 0.62, 0.12);
    config.bvh.layout = Layout::binary;
    EXPECT_LT(error_of(render_by_own_kernels(scene, config), sixteen), 1e-6);
}

TEST(LightGrid, RefusesWhatItCannotDo) {
    const Scene scene = *builtin_scene("cornell");
    const auto refused = [&](const RenderConfig& config, const char* words) {
        EXPECT_TRUE(throws_error(ErrorKind::usage, words, [&] { Renderer(device(), scene, config); }));
    };
    refused(by_grid(8, 1, {.side = 1}), "2 to 64 probes");
    refused(by_grid(8, 1, {.coefficients = 5}), "4 or 9 coefficients");
    refused(by_grid(8, 1, {.levels = 0}), "1 to 4 levels");
    refused(by_grid(8, 1, {.rays = 0}), "8 to 4096 rays");
    refused(by_grid(8, 1, {.updates = 0}), "one update");
    RenderConfig both = by_grid(8, 1);
    both.approximate.tile_sum = true;
    refused(both, "exclude each other");
    Renderer probes(device(), scene, by_grid(8, 1, {.side = 4}));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no voxels", [&] { (void)probes.voxels(); }));
}

}  // namespace
}  // namespace claray::test
