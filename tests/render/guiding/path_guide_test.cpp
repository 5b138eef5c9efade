// Path guiding, render/guiding/learn_light.cl: maps are densities, and images keep their mean, whatever divides the
// samples.
#include "host/render/guiding/path_guide.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "claray/io.hpp"
#include "host/verify/run.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

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

RenderConfig guided_config() { return {.width = 128, .height = 128, .spp = 64, .max_depth = 6, .guide = true}; }

std::vector<glm::vec3> render_guided(const Scene& scene, unsigned least, RenderConfig config) {
    const verify::ScopedTuning gain(device(), stem, least_gain, least);
    return render_by_own_kernels(scene, config);
}

double luminance(const glm::vec3& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

bool is_guidable() { return device().info().type == DeviceType::cpu; }

std::vector<GuideBin> bins_of_a_map(const std::function<GuideBin(std::size_t)>& bin) {
    std::vector<GuideBin> bins;
    for (std::size_t i = 0; i < CLARAY_GUIDE_BINS; ++i) bins.push_back(bin(i));
    return bins;
}

TEST(PathGuide, MapsAreDensities) {
    const std::vector<GuideBin> bins = bins_of_a_map([](std::size_t i) {
        return GuideBin{i == 13 ? 1u << 30 : 5, 40, 0};
    });
    const std::vector<std::uint64_t> shares = shares_of_bins(guide_maps(bins));
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), std::uint64_t(0)), std::uint64_t(1) << 32);
    const double even = std::exp2(32) / CLARAY_GUIDE_BINS;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        EXPECT_GT(double(shares[i]), 0.39 * even) << i;
        if (i != 13) {
            EXPECT_LT(shares[i], shares[13]) << i;
        }
    }
}

TEST(PathGuide, UnknownMapsAreUniform) {
    const std::vector<GuideBin> few = bins_of_a_map([](std::size_t i) {
        return GuideBin{i == 13 ? 1u << 30 : 0, 1, 0};
    });
    for (const std::uint64_t share : shares_of_bins(guide_maps(few)))
        EXPECT_EQ(share, (std::uint64_t(1) << 32) / CLARAY_GUIDE_BINS);
}

TEST(PathGuide, GainIsThatOfTheMaps) {
    const std::vector<GuideBin> one = bins_of_a_map([](std::size_t i) {
        return GuideBin{i == 13 ? 1u << 30 : 0, 400, 0};
    });
    const std::vector<std::uint32_t> maps = guide_maps(one);
    const double share = double(shares_of_bins(maps)[13]) / std::exp2(32);
    EXPECT_NEAR(gain_of(maps, one), share * CLARAY_GUIDE_BINS, 1e-6);
    const std::vector<GuideBin> other = bins_of_a_map([](std::size_t i) {
        return GuideBin{i == 14 ? 1u << 30 : 0, 400, 0};
    });
    EXPECT_LT(gain_of(maps, other), 1);
}

/// The sum of pixels, and the squared differences of two seeds.
struct Sums {
    double light = 0, squares = 0;
};
Sums sums_of(unsigned least) {
    RenderConfig config = guided_config();
    config.seed = 1;
    const std::vector<glm::vec3> one = render_guided(room_with_window(), least, config);
    config.seed = 2;
    const std::vector<glm::vec3> other = render_guided(room_with_window(), least, config);
    Sums sums;
    for (std::size_t i = 0; i < one.size(); ++i) {
        const double a = luminance(one[i]), b = luminance(other[i]);
        sums.light += (a + b) / 2, sums.squares += (a - b) * (a - b);
    }
    return sums;
}

TEST(PathGuide, KeepsTheMeanWithLessNoise) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const Sums without = sums_of(nowhere), with = sums_of(everywhere);
    EXPECT_GT(without.squares, 1.3 * with.squares);
    const double deviation =
        std::sqrt((without.squares + with.squares) / 4);  // half a squared difference for each image of two
    EXPECT_NEAR(with.light, without.light, 4 * deviation);
    EXPECT_LT(4 * deviation, 0.01 * without.light) << "or the test would see little";
}

TEST(PathGuide, DependsNeitherOnBatchesNorOnLanes) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const Scene scene = room_with_window();
    const std::vector<glm::vec3> image = render_guided(scene, everywhere, guided_config());
    EXPECT_FALSE(same_bits(image, render_guided(scene, nowhere, guided_config()))) << "nothing is guided";
    EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, guided_config())));
    {
        const verify::ScopedTuning first(device(), "render/wavefront", "FIRST_PATHS", 1024);
        EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, guided_config()))) << "batches";
    }
    RenderConfig all = guided_config();
    all.effects.add = full_effects();
    EXPECT_TRUE(same_bits(image, render_guided(scene, everywhere, all))) << "one ray at once";
}

TEST(PathGuide, LeavesImagesThatItDoesNotImprove) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const unsigned usual = device().tuning(stem, least_gain);
    const auto is_guided = [&](const Scene& scene) {
        const RenderConfig config{.width = 224, .height = 224, .spp = least_guided_spp, .guide = true};
        return !same_bits(render_guided(scene, usual, config), render_guided(scene, nowhere, config));
    };
    EXPECT_FALSE(is_guided(*builtin_scene("spheres")));
    EXPECT_TRUE(is_guided(*builtin_scene("cornell")));
}

/// The cells span the scene as it is now.
TEST(PathGuide, FollowsMovedVertices) {
    if (!is_guidable()) GTEST_SKIP() << "paths are guided on CPUs only";
    const verify::ScopedTuning gain(device(), stem, least_gain, everywhere);
    RenderConfig config = guided_config();
    config.width = config.height = 64, config.spp = least_guided_spp;
    const Scene small = room_with_window();
    Scene large = small;
    for (Mesh& mesh : large.meshes)
        for (glm::vec3& p : mesh.positions) p *= 3;
    Renderer moved(device(), small, config), made(device(), large, config);
    moved.update(large, {.vertices = true});
    moved.restart(0);
    moved.render(), made.render();
    EXPECT_TRUE(same_bits(moved.image(), made.image()));
}

TEST(PathGuide, LeavesShortRendersAlone) {
    RenderConfig config = guided_config();
    config.spp = least_guided_spp - 1;
    const Scene scene = room_with_window();
    EXPECT_TRUE(same_bits(render_guided(scene, everywhere, config), render_guided(scene, nowhere, config)));
}

}  // namespace
}  // namespace claray::test
