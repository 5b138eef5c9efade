// Path guiding, render/guiding/learn_light.cl: maps are densities, and images keep their mean, whatever divides the
// samples.
#include "host/render/guiding/path_guide.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "claray/io.hpp"
#include "host/compute/contexts.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

constexpr const char* stem = "render/path_guide";
constexpr const char* least_gain = "LEAST_GAIN_PERCENT";
constexpr unsigned nowhere = 0, everywhere = 1;

/// A room with a window, lit by the sky alone.
Scene room_with_window() {
    Scene scene;
    scene.materials = {lambert(0.8f)};
    const auto quad = [&](glm::vec3 center, glm::vec3 u, glm::vec3 v) {
        Mesh mesh;
        mesh.positions = {center - u - v, center + u - v, center + u + v, center - u + v};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        scene.meshes.push_back(mesh);
    };
    const glm::vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    for (const float side : {-1.f, 1.f}) quad(side * y, x, z), quad(side * z, x, y);
    quad(x, y, z);
    quad({-1, -0.6f, 0}, 0.4f * y, z), quad({-1, 0.8f, 0}, 0.2f * y, z);
    quad({-1, 0.2f, -0.7f}, 0.4f * y, 0.3f * z), quad({-1, 0.2f, 0.7f}, 0.4f * y, 0.3f * z);
    scene.sky.horizon = scene.sky.zenith = {2, 2, 3};
    Camera camera;
    camera.position = {0.9f, 0.1f, 0.8f}, camera.target = {-0.3f, -0.3f, -0.6f};
    scene.camera = camera;
    return scene;
}

RenderConfig guided_config() { return {.width = 128, .height = 128, .spp = 64, .max_depth = 6}; }

std::vector<glm::vec3> render_guided(const Scene& scene, unsigned least, RenderConfig config) {
    const claray::ScopedTuning gain(device(), stem, least_gain, least);
    return render_by_own_kernels(scene, config);
}

double luminance(const glm::vec3& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

bool is_guidable() { return device().info().type == DeviceType::cpu; }

/// Of one map in all folds.
std::vector<GuideBin> found_in_a_map(const std::function<GuideBin(std::size_t fold, std::size_t bin)>& found) {
    std::vector<GuideBin> bins;
    for (std::size_t fold = 0; fold < CLARAY_GUIDE_FOLDS; ++fold)
        for (std::size_t i = 0; i < CLARAY_GUIDE_BINS; ++i) bins.push_back(found(fold, i));
    return bins;
}

GuideBin lit(bool is_lit, std::uint32_t paths) {
    const std::uint64_t light = is_lit ? 1u << 28 : 0;
    return {light, light, paths, 0};
}

TEST(PathGuide, MapsAreDensities) {
    const std::vector<GuideBin> bins = found_in_a_map([](std::size_t, std::size_t i) { return lit(i == 13, 4000); });
    const std::vector<std::uint64_t> shares = shares_of_bins(guide_maps(bins));
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), std::uint64_t(0)), std::uint64_t(1) << 32);
    const double even = std::exp2(32) / CLARAY_GUIDE_BINS;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        EXPECT_GT(double(shares[i]), 0.39 * even) << i;
        if (i != 13) {
            EXPECT_LT(shares[i], shares[13] / 4) << i;
        }
    }
}

TEST(PathGuide, UnknownMapsAreUniform) {
    const std::vector<GuideBin> few =
        found_in_a_map([](std::size_t fold, std::size_t i) { return lit(i == 13, fold == 0 ? 1 : 0); });
    for (const std::uint64_t share : shares_of_bins(guide_maps(few)))
        EXPECT_EQ(share, (std::uint64_t(1) << 32) / CLARAY_GUIDE_BINS);
}

/// Maps are tried on the fold from which they did not learn.
TEST(PathGuide, GainIsThatOfOtherSamples) {
    const std::vector<GuideBin> one = found_in_a_map([](std::size_t, std::size_t i) { return lit(i == 13, 400); });
    const std::vector<GuideBin> two_folds =
        found_in_a_map([](std::size_t fold, std::size_t i) { return fold < 2 ? lit(i == 13, 400) : GuideBin{}; });
    const double share = double(shares_of_bins(guide_maps(two_folds))[13]) / std::exp2(32);
    EXPECT_NEAR(try_guiding(one).gain(), share * CLARAY_GUIDE_BINS, 1e-6);
    const std::vector<GuideBin> others =
        found_in_a_map([](std::size_t fold, std::size_t i) { return lit(i == 13 + fold, 400); });
    EXPECT_LT(try_guiding(others).gain(), 1) << "no fold has light where the others have";
}

TEST(PathGuide, AGainOfFewMapsIsUncertain) {
    const std::vector<GuideBin> one = found_in_a_map([](std::size_t, std::size_t i) { return lit(i == 13, 400); });
    const auto in_maps = [&](std::size_t count) {
        std::vector<GuideBin> all;
        for (std::size_t fold = 0; fold < CLARAY_GUIDE_FOLDS; ++fold)
            for (std::size_t map = 0; map < count; ++map)
                all.insert(all.end(), one.begin(), one.begin() + CLARAY_GUIDE_BINS);
        return try_guiding(all);
    };
    EXPECT_NEAR(in_maps(1).least_gain(), 1, 1e-6);
    EXPECT_NEAR(in_maps(16).gain(), in_maps(1).gain(), 1e-6);
    EXPECT_NEAR(in_maps(16).least_gain() - 1, 0.75 * (in_maps(1).gain() - 1), 1e-6);
}

/// Guided paths stay in the scene longer if light comes from its surfaces. Those that leave it earlier promise nothing
/// more.
TEST(PathGuide, LongerPathsLowerThePromise) {
    const auto trial = [](std::uint32_t longer_to_light) {
        std::vector<GuideBin> all;
        for (std::size_t i = 0; i < CLARAY_GUIDE_FOLDS * 16 * CLARAY_GUIDE_BINS; ++i) {
            const bool is_light = i % CLARAY_GUIDE_BINS == 13;
            all.push_back(lit(is_light, 400));
            all.back().longer = is_light ? longer_to_light : 20;
        }
        return try_guiding(all);
    };
    EXPECT_NEAR(trial(20).cost(), 1, 1e-6);
    EXPECT_LT(trial(0).cost(), 0.95);
    EXPECT_GT(trial(400).cost(), 1.5);
    EXPECT_NEAR(trial(400).promise() * trial(400).cost(), trial(20).promise(), 1e-6);
    EXPECT_NEAR(trial(0).promise(), trial(20).promise(), 1e-6);
}

/// Numbers next to 1 are in the last bin, also where the last interval is narrow.
TEST(PathGuide, GuidedNumbersAreBelowOne) {
    const std::string source = R"(#define PATH_GUIDE 1
#include "render/guiding/path_guide.clh"
kernel void draw(uint word, global const uint* map, global float* drawn) {
    const SamplePair words = {word, word};
    float2 random;
    drawn[2] = guided(map, 0, words, &random);
    drawn[0] = random.x, drawn[1] = random.y;
})";
    Kernel draw = compile_kernel(device(), source, "draw");
    for (const bool is_lit : {false, true}) {
        const std::vector<GuideBin> bins =
            found_in_a_map([&](std::size_t, std::size_t i) { return lit(is_lit && i == 0, 400); });
        const std::vector<std::uint32_t> map = guide_maps(bins);
        const Buffer<std::uint32_t> maps(device(), map);
        Buffer<float> drawn(device(), 3);
        for (const std::uint32_t word : {0xffffffffu, 0xfffffffeu, 0xffffff00u, 0x80000000u, 0u}) {
            draw.run({1, 1}, word, maps, drawn);
            const std::vector<float> found = drawn.read();
            for (const float number : {found[0], found[1]}) {
                EXPECT_GE(number, 0.f) << word;
                EXPECT_LT(number, 1.f) << word;
            }
            const std::size_t bin = std::size_t(found[0] * 8) * 8 + std::size_t(found[1] * 8);
            ASSERT_LT(bin, std::size_t(CLARAY_GUIDE_BINS));
            EXPECT_NEAR(double(found[2]), double(shares_of_bins(map)[bin]) * CLARAY_GUIDE_BINS / std::exp2(32), 1e-5);
        }
    }
}

/// The sum of pixels, and the squared differences of two seeds.
struct Sums {
    double light = 0, squares = 0;
};
Sums sums_of(const Scene& scene, unsigned least) {
    RenderConfig config = guided_config();
    config.seed = 1;
    const std::vector<glm::vec3> one = render_guided(scene, least, config);
    config.seed = 2;
    const std::vector<glm::vec3> other = render_guided(scene, least, config);
    Sums sums;
    for (std::size_t i = 0; i < one.size(); ++i) {
        const double a = luminance(one[i]), b = luminance(other[i]);
        sums.light += (a + b) / 2, sums.squares += (a - b) * (a - b);
    }
    return sums;
}

void keeps_the_mean_with_less_noise(const Scene& scene) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const Sums without = sums_of(scene, nowhere), with = sums_of(scene, everywhere);
    EXPECT_GT(without.squares, 1.3 * with.squares);
    const double deviation =
        std::sqrt((without.squares + with.squares) / 4);  // half a squared difference for each image of two
    EXPECT_NEAR(with.light, without.light, 4 * deviation);
    EXPECT_LT(4 * deviation, 0.01 * without.light) << "or the test would see little";
}

TEST(PathGuide, KeepsTheMeanWithLessNoise) { keeps_the_mean_with_less_noise(room_with_window()); }

/// Of other materials it guides the diffuse lobe.
TEST(PathGuide, KeepsTheMeanOfPlastic) {
    Scene scene = room_with_window();
    scene.materials[0].kind = MaterialKind::principled, scene.materials[0].roughness = 0.3f;
    keeps_the_mean_with_less_noise(scene);
}

TEST(PathGuide, DependsNeitherOnBatchesNorOnLanes) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const Scene scene = room_with_window();
    RenderConfig config = guided_config();
    config.spp = 32;
    const std::vector<glm::vec3> image = render_guided(scene, everywhere, config);
    EXPECT_FALSE(same_bits(image, render_guided(scene, nowhere, config))) << "nothing is guided";
    EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, config)));
    {
        const claray::ScopedTuning first(device(), "render/wavefront", "FIRST_PATHS", 1024);
        EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, config))) << "batches";
    }
    RenderConfig one = config;
    one.effects.add = {Effect::vertex_colors};
    EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, one))) << "one ray at once";
}

TEST(PathGuide, LeavesImagesThatItDoesNotImprove) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const unsigned usual = device().tuning(stem, least_gain);
    const auto is_guided = [&](const Scene& scene) {
        const RenderConfig config{.width = 224, .height = 224, .spp = 32};
        return !same_bits(render_guided(scene, usual, config), render_guided(scene, nowhere, config));
    };
    EXPECT_FALSE(is_guided(*builtin_scene("spheres")));
    EXPECT_TRUE(is_guided(*builtin_scene("cornell")));
}

/// Textures on diffuse surfaces, and glTF's name for such a surface, change nothing.
TEST(PathGuide, GuidesAtWhateverIsLambertian) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    Scene scene = room_with_window();
    Texture texture;
    texture.width = texture.height = 2;
    texture.bytes.assign(16, 200);
    texture.filter = Filter::bilinear;
    scene.textures = {texture};
    scene.materials[0].albedo_map = {.texture = 0};
    for (Mesh& mesh : scene.meshes) mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    RenderConfig config = guided_config();
    config.spp = 32;
    const std::vector<glm::vec3> image = render_guided(scene, everywhere, config);
    EXPECT_FALSE(same_bits(image, render_guided(scene, nowhere, config))) << "nothing is guided";
    scene.materials[0].kind = MaterialKind::principled;
    scene.materials[0].roughness = 1.f, scene.materials[0].specular_weight = 0.f;
    EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, config)));
    EXPECT_EQ(Renderer(device(), scene, config).why_unguided(), "");
    scene.materials[0].kind = MaterialKind::mirror;
    EXPECT_NE(Renderer(device(), scene, config).why_unguided(), "") << "mirrors";
    config.guide = false;
    EXPECT_EQ(Renderer(device(), scene, config).why_unguided(), "") << "not asked for";
}

/// The cells span the scene as it is now.
TEST(PathGuide, FollowsMovedVertices) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const claray::ScopedTuning gain(device(), stem, least_gain, everywhere);
    RenderConfig config = guided_config();
    config.spp = 32;
    const Scene small = room_with_window();
    Scene large = small;
    for (Mesh& mesh : large.meshes)
        for (glm::vec3& p : mesh.positions) p *= 3;
    Renderer moved(device(), small, config), made(device(), large, config);
    moved.update(large, {.vertices = true});
    moved.restart(0);
    moved.render(), made.render();
    EXPECT_TRUE(same_bits(moved.image(), made.image()));
    EXPECT_FALSE(same_bits(moved.image(), render_guided(large, nowhere, config))) << "nothing is guided";
}

/// Renders a part, continues from its checkpoint, and compares with a render without interruption.
void expect_same_when_resumed(RenderConfig config, std::initializer_list<unsigned> samples) {
    const claray::ScopedTuning gain(device(), stem, least_gain, everywhere);
    const TemporaryFolder folder;
    const Scene scene = room_with_window();
    const std::vector<glm::vec3> whole = render_by_own_kernels(scene, config);
    EXPECT_FALSE(same_bits(whole, render_guided(scene, nowhere, config))) << "nothing is guided";
    config.checkpoint = folder / "c", config.report_seconds = 0.02;
    RenderConfig resumed = config;
    resumed.resume = config.checkpoint;
    for (const unsigned spp : samples) {
        Renderer(device(), scene, config).render([&](const RenderProgress& at) { return at.spp < spp; });
        EXPECT_TRUE(same_bits(render_by_own_kernels(scene, resumed), whole)) << "resumed after " << spp;
    }
}

/// Before, between and after the samples that teach.
TEST(PathGuide, ResumedIsUninterruptedBitForBit) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    RenderConfig config = guided_config();
    config.spp = 40;
    expect_same_when_resumed(config, {1, 3, 6, 9, 12, 17, 33});
}

/// A sample does not depend on how many follow. Short renders learn less, or nothing.
TEST(PathGuide, ContinuesShorterRenders) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const claray::ScopedTuning gain(device(), stem, least_gain, everywhere);
    const TemporaryFolder folder;
    RenderConfig config = guided_config();
    config.spp = 20;
    const std::vector<glm::vec3> whole = render_by_own_kernels(room_with_window(), config);
    config.checkpoint = folder / "c";
    for (const unsigned spp : {unguided_spp, unguided_spp + 4, teaching_spp, teaching_spp + 1}) {
        config.spp = spp, config.resume.clear();
        (void)render_by_own_kernels(room_with_window(), config);
        config.spp = 20, config.resume = config.checkpoint;
        EXPECT_TRUE(same_bits(render_by_own_kernels(room_with_window(), config), whole)) << "continued from " << spp;
    }
}

/// A renderer keeps its guide, and forgets what it has learned.
TEST(PathGuide, RestartedIsNewBitForBit) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const claray::ScopedTuning gain(device(), stem, least_gain, everywhere);
    RenderConfig config = guided_config();
    config.spp = 20;
    const Scene scene = room_with_window();
    Renderer renderer(device(), scene, config);
    const auto image = [&] {
        renderer.render();
        return renderer.image();
    };
    const std::vector<glm::vec3> first = image();
    renderer.restart(0);
    EXPECT_TRUE(same_bits(image(), first)) << "restarted when it had learned all";
    renderer.restart(0);
    renderer.render([](const RenderProgress& at) { return at.spp < 5; });
    renderer.restart(0);
    EXPECT_TRUE(same_bits(image(), first)) << "restarted while it learned";
    renderer.restart(0, 4);
    renderer.render();
    renderer.restart(0, 20);
    EXPECT_TRUE(same_bits(image(), first)) << "restarted after an image of which nothing is learned";
    renderer.update(scene, {.materials = true});
    EXPECT_TRUE(same_bits(image(), first)) << "tables were written again";
    renderer.resize(160, 128);
    renderer.render();
    renderer.resize(128, 128);
    EXPECT_TRUE(same_bits(image(), first)) << "another size and back";
}

/// Only some pixels teach, and these are traced again.
TEST(PathGuide, LargeImagesResumeBitForBit) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    expect_same_when_resumed({.width = 401, .height = 400, .spp = 32, .max_depth = 3}, {17});
}

TEST(PathGuide, CheckpointsOfUnguidedRendersAreRefused) {
    const TemporaryFolder folder;
    RenderConfig config = guided_config();
    config.spp = 10, config.guide = false;
    config.checkpoint = folder / "c";
    (void)render_by_own_kernels(room_with_window(), config);
    config.resume = config.checkpoint, config.spp = 12, config.guide = true;
    EXPECT_TRUE(throws_error(ErrorKind::user, "--no-guide", [&] { Renderer(device(), room_with_window(), config); }));
    config.guide = false;
    EXPECT_EQ(Renderer(device(), room_with_window(), config).render().spp, 12u);
}

/// Too few paths of a small image would teach too little.
TEST(PathGuide, LeavesSmallImagesAlone) {
    RenderConfig config = guided_config();
    config.width = 127, config.spp = 32;
    const Scene scene = room_with_window();
    EXPECT_TRUE(same_bits(render_guided(scene, everywhere, config), render_guided(scene, nowhere, config)));
}

TEST(PathGuide, LeavesShortRendersAlone) {
    RenderConfig config = guided_config();
    config.spp = unguided_spp;
    const Scene scene = room_with_window();
    EXPECT_TRUE(same_bits(render_guided(scene, everywhere, config), render_guided(scene, nowhere, config)));
}

}  // namespace
}  // namespace claray::test
