// Images with alpha, holdouts and shadow catchers: render/layers/mask_paths.cl.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "claray/scale/render_group.hpp"
#include "host/render/layers/matte.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

const glm::vec3 sky(0.6f, 0.8f, 1.1f);

/// A block over a floor, which is material 1, under a sky and a lamp above.
Scene block_over_floor() {
    Scene scene;
    scene.materials = {lambert(0.4f), lambert(0.6f), emitter(40)};
    scene.meshes = {square(0.6f, 0.8f, 0), square(4, 0, 1), square(0.3f, 4, 2)};
    scene.sky.horizon = scene.sky.zenith = sky;
    scene.camera = Camera{.position = {0, 3, 7}, .target = {0, 0.5f, 0}};
    return scene;
}

RenderConfig config_of(unsigned spp = 64) {
    RenderConfig config{.width = 40, .height = 30, .spp = spp};
    config.alpha = true;
    return config;
}

struct Render {
    std::vector<glm::vec3> image;
    std::vector<float> alpha;
};
Render rendered(const Scene& scene, const RenderConfig& config) {
    Renderer renderer(device(), scene, config);
    renderer.render();
    return {renderer.image(), renderer.alpha()};
}

TEST(Alpha, CompositedOverTheBackgroundGivesTheImage) {
    for (const char* name : {"", "effect:instances", "effect:primitives", "effect:cut-outs", "effect:rough-glass"}) {
        Scene scene = *name ? *builtin_scene(name) : block_over_floor();
        scene.environment = {}, scene.sky.horizon = scene.sky.zenith = sky, scene.sky.fog_density = 0;
        RenderConfig opaque = config_of();
        opaque.alpha = false;
        const Render with = rendered(scene, config_of()), without = rendered(scene, opaque);
        EXPECT_EQ(*std::min_element(without.alpha.begin(), without.alpha.end()), 1.f);
        float least = 1, most = 0;
        for (std::size_t i = 0; i < with.image.size(); ++i) {
            least = std::min(least, with.alpha[i]), most = std::max(most, with.alpha[i]);
            const glm::vec3 over = with.image[i] + (1 - with.alpha[i]) * sky;
            EXPECT_LT(glm::length(over - without.image[i]), 2e-5f * (1 + glm::length(over))) << name << ' ' << i;
        }
        EXPECT_EQ(least, 0.f) << name;
        EXPECT_EQ(most, 1.f) << name;
    }
}

/// What covers part of a pixel has that share: the camera's rays are spread over the pixel.
TEST(Alpha, IsTheCoveredShareOfAPixel) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    Mesh mesh;  // covers the lower left triangle of the image
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    scene.meshes = {mesh};
    scene.camera = Camera{.position = {0, 0, 5}, .projection = Projection::orthographic, .orthographic_height = 2.f};
    const unsigned side = 8;
    RenderConfig config{.width = side, .height = side, .spp = 1024};
    config.alpha = true;
    const std::vector<float> alpha = rendered(scene, config).alpha;
    for (unsigned y = 0; y < side; ++y)
        for (unsigned x = 0; x < side; ++x) {
            const float expected = x < y ? 1.f : x == y ? 0.5f : 0.f;
            EXPECT_NEAR(alpha[y * side + x], expected, 0.01f) << x << ' ' << y;
        }
}

TEST(Alpha, OfGlassIsOne) {
    Scene scene = block_over_floor();
    scene.materials[0] = material(MaterialKind::glass, 1.f);
    scene.materials[0].thin_walled = true;
    scene.meshes = {scene.meshes[0]};
    scene.camera = narrow_camera({0, 3, 1}, {0, 0.8f, 0});
    const Render render = rendered(scene, config_of());
    for (std::size_t i = 0; i < render.alpha.size(); ++i) {
        EXPECT_EQ(render.alpha[i], 1.f);
        EXPECT_NEAR(render.image[i].x, sky.x, 0.02f) << "the sky is seen through it";
    }
}

TEST(Holdouts, AreCutOutAndStillCastShadows) {
    Scene scene = block_over_floor();
    const Render all = rendered(scene, config_of());
    scene.materials[0].role = MaterialRole::holdout;
    const Render without = rendered(scene, config_of());
    unsigned cut = 0, kept = 0;
    const Aovs aovs = Renderer(device(), scene, config_of()).aovs();
    for (std::size_t i = 0; i < all.alpha.size(); ++i) {
        EXPECT_LE(without.alpha[i], all.alpha[i]);
        if (without.alpha[i] == 0 && aovs.material[i] == 0) {
            ++cut;
            EXPECT_EQ(without.image[i], glm::vec3(0.f));
        }
        if (without.alpha[i] == 1) {
            ++kept;
            EXPECT_EQ(without.image[i], all.image[i]);
        }
    }
    EXPECT_GT(cut, 4u);
    EXPECT_GT(kept, 200u);
}

TEST(ShadowCatchers, CompositedOverTheBareFloorGiveTheFloorInShadow) {
    Scene scene = block_over_floor();
    RenderConfig opaque = config_of(), other = config_of(1024);
    opaque.alpha = other.alpha = false, other.seed = 7;
    const Render truth = rendered(scene, opaque), independent = rendered(scene, other);
    scene.materials[1].role = MaterialRole::shadow_catcher;
    const Render caught = rendered(scene, config_of());
    const Render bare = rendered(scene_of_catchers(scene), opaque);
    const Aovs aovs = Renderer(device(), scene, config_of()).aovs();
    double difference = 0, noise = 0, sum = 0;
    float darkest = 0;
    for (std::size_t i = 0; i < caught.image.size(); ++i) {
        const glm::vec3 over = caught.image[i] + (1 - caught.alpha[i]) * bare.image[i];
        EXPECT_LT(glm::length(over - truth.image[i]), 0.02f * (1 + glm::length(over))) << i << ' ' << caught.alpha[i];
        difference += std::abs(double(over.y - independent.image[i].y)), sum += double(over.y);
        noise += std::abs(double(truth.image[i].y - independent.image[i].y));
        if (aovs.material[i] == 1) darkest = std::max(darkest, caught.alpha[i]);
    }
    EXPECT_LT(difference, 1.05 * noise) << "as near to another render of the floor as this render of it is";
    EXPECT_LT(noise, 0.05 * sum);
    EXPECT_GT(darkest, 0.3f) << "the shadow on the floor";
    EXPECT_LT(caught.alpha[39], 0.02f) << "far from the block there is no shadow";
}

/// The second renderer follows.
TEST(ShadowCatchers, FollowTheCameraAndRefuseOtherChanges) {
    Scene scene = block_over_floor();
    scene.materials[1].role = MaterialRole::shadow_catcher;
    Renderer renderer(device(), scene, config_of(16));
    renderer.render();
    scene.camera->position.x += 1;
    renderer.update(scene, {.camera = true});
    renderer.render();
    const Render made = rendered(scene, config_of(16));
    EXPECT_EQ(renderer.alpha(), made.alpha);
    EXPECT_TRUE(same_bits(renderer.image(), made.image));
    EXPECT_THROW(renderer.update(scene, {.instances = true}), Error);
    renderer.resize(20, 16);
    renderer.render();
    RenderConfig config = config_of(16);
    config.width = 20, config.height = 16;
    EXPECT_EQ(renderer.alpha(), rendered(scene, config).alpha);
    const std::span<const std::uint8_t> picture = renderer.picture();
    EXPECT_EQ(picture.size(), 4u * 20 * 16);
}

TEST(Alpha, ChangesNoBitWhereItIsNotAskedFor) {
    Scene scene = block_over_floor();
    RenderConfig opaque = config_of();
    opaque.alpha = false;
    const Render plain = rendered(scene, opaque);
    scene.materials[0].role = MaterialRole::holdout, scene.materials[1].role = MaterialRole::shadow_catcher;
    EXPECT_TRUE(same_bits(rendered(scene, opaque).image, plain.image));
}

/// Rounds of adaptive sampling list pixels.
TEST(Alpha, WorksWithAdaptiveSampling) {
    Scene scene = block_over_floor();
    RenderConfig config = config_of(64);
    config.adaptive = true;
    const Render adaptive = rendered(scene, config), uniform = rendered(scene, config_of(64));
    for (std::size_t i = 0; i < adaptive.alpha.size(); ++i) EXPECT_NEAR(adaptive.alpha[i], uniform.alpha[i], 0.1f) << i;
    scene.materials[1].role = MaterialRole::shadow_catcher;
    EXPECT_THROW(Renderer(device(), scene, config), Error);
}

TEST(Alpha, RefusesCheckpointsAndSeveralDevices) {
    const Scene scene = block_over_floor();
    EXPECT_THROW(RenderGroup({device(), device()}, scene, config_of()), Error);
    RenderConfig config = config_of();
    config.checkpoint = "c";
    EXPECT_THROW(Renderer(device(), scene, config), Error);
}

}  // namespace
}  // namespace claray::test
