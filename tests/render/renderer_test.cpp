// The stages of the wavefront, as seen in images: render/generate_rays.cl, render/shade_surface.cl,
// render/add_light.cl, render/queues/empty_queues.cl and render/write_aovs.cl.
#include "claray/renderer.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "host/base/seconds_since.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

TEST(Renderer, SlicesDoNotChangeTheBits) {
    const Scene scene = *builtin_scene("cornell");
    const RenderConfig config{.width = 61, .height = 43, .spp = 21};
    const std::vector<glm::vec3> image = render_image(scene, config);
    for (const unsigned paths : {500u, 5'000u}) {
        const ScopedTuning tuning("render/wavefront", "PATHS", paths);
        EXPECT_TRUE(same_bits(image, render_image(scene, config))) << paths << " paths";
    }
    for (const unsigned paths : {5u, 500u}) {
        const ScopedTuning tuning("render/wavefront", "FIRST_PATHS", paths);
        EXPECT_TRUE(same_bits(image, render_image(scene, config))) << "beginning with " << paths << " paths";
    }
    const ScopedTuning tuning("render/wavefront", "BOUNCES_PER_LOOK", 3);
    EXPECT_TRUE(same_bits(image, render_image(scene, config))) << "counting every third bounce";
}

TEST(Renderer, StoppingAndGoingOnDoesNotChangeTheBits) {
    const Scene scene = *builtin_scene("cornell");
    const RenderConfig config{.width = 300, .height = 200, .spp = 12};
    const ScopedTuning tuning("render/wavefront", "PATHS", 10'000);
    Renderer renderer(device(), scene, config);
    unsigned stops = 0;
    RenderProgress progress;
    do {
        progress = renderer.render([](const RenderProgress&) { return false; });
        ++stops;
    } while (progress.spp < config.spp);
    EXPECT_GT(stops, 10u);
    EXPECT_TRUE(same_bits(renderer.image(), render_image(scene, config)));
}

TEST(Renderer, EverySampleIsInTheImageOnce) {
    Scene scene;
    scene.materials = {lambert(0.f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.sky = {glm::vec3(0.25f), glm::vec3(0.25f)};
    scene.camera = Camera{{0, 3, 0}, {0, 9, 0}, {0, 0, 1}, 40.f};  // sees only the sky
    for (const unsigned spp : {1u, 2u, 3u, 37u, 100u})
        for (const glm::vec3& pixel : render_image(scene, {.width = 13, .height = 7, .spp = spp}))
            ASSERT_EQ(pixel, glm::vec3(0.25f)) << spp;
}

double luminance(const glm::vec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// Root mean square over pixels, relative to the mean, as RenderProgress::noise.
double true_error(const std::vector<glm::vec3>& image, const std::vector<glm::vec3>& reference) {
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        squares += std::pow(luminance(image[i]) - luminance(reference[i]), 2);
        sum += luminance(reference[i]);
    }
    return std::sqrt(squares * double(image.size())) / sum;
}

/// Looking down: with the lamp in view, the few pixels at its edge would make up all of the noise.
TEST(Renderer, NoiseEstimateIsTheTrueError) {
    Scene scene = *builtin_scene("cornell");
    scene.camera = Camera{{0.278f, 0.54f, 0.1f}, {0.278f, 0.f, 0.35f}, {0.f, 1.f, 0.f}, 70.f};
    const auto reference = render_by_own_kernels(scene, {.width = 48, .height = 48, .spp = 2048, .seed = 99});
    for (const Sampler sampler : {Sampler::sobol, Sampler::independent}) {
        double estimated = 0, error = 0;
        for (std::uint32_t seed = 0; seed < 4; ++seed) {
            Renderer renderer(device(), scene,
                              {.width = 48, .height = 48, .spp = 16, .seed = seed, .sampler = sampler});
            estimated += std::pow(renderer.render().noise, 2);
            error += std::pow(true_error(renderer.image(), reference), 2);
        }
        EXPECT_NEAR(std::sqrt(estimated / error), 1, 0.1) << "sampler " << int(sampler);
    }
}

TEST(Renderer, StopsAtTheNoiseLimit) {
    Renderer renderer(device(), *builtin_scene("cornell"), {.width = 48, .height = 48, .spp = 100'000, .noise = 0.02});
    const RenderProgress progress = renderer.render();
    EXPECT_LE(progress.noise, 0.02);
    EXPECT_GT(progress.noise, 0.01);
    EXPECT_LT(progress.spp, 5000u);
}

double rmse_over_mean(const std::vector<glm::vec3>& image, const std::vector<glm::vec3>& reference) {
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            squares += std::pow(double(image[i][c]) - double(reference[i][c]), 2);
            sum += double(reference[i][c]);
        }
    return std::sqrt(squares / (3.0 * double(image.size()))) / (sum / (3.0 * double(image.size())));
}

TEST(Renderer, StopsAtAnErrorThatIsTrue) {
    const Scene scene = *builtin_scene("spheres");
    const auto reference = render_by_own_kernels(scene, {.width = 24, .height = 24, .spp = 2048, .seed = 99});
    unsigned held = 0, last_spp = 0;
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
        const double target = seed % 2 == 0 ? 0.15 : 0.08;
        const RenderConfig config{.width = 24, .height = 24, .spp = 1u << 20, .seed = seed, .error = target};
        Renderer renderer(device(), scene, config);
        const RenderProgress reached = renderer.render();
        const double error = rmse_over_mean(renderer.image(), reference);
        held += error <= target;
        EXPECT_GT(error, target / 3) << seed;
        EXPECT_LE(reached.error_bound, target);
        EXPECT_LT(reached.error, reached.error_bound);
        if (seed % 2 == 1) {
            EXPECT_GT(reached.spp, last_spp) << "a smaller error needs more";
        }
        last_spp = reached.spp;
        EXPECT_GT(renderer.statistics().measuring_seconds, 0);
    }
    EXPECT_GE(held, 7u);
    Renderer renderer(device(), scene, {.width = 24, .height = 24, .spp = 9, .error = 1e-6});
    EXPECT_EQ(renderer.render().spp, 9u) << "no more than it may";
    EXPECT_TRUE(same_bits(renderer.image(), render_image(scene, {.width = 24, .height = 24, .spp = 9})))
        << "what is measured changes nothing";
}

TEST(Renderer, BeginsAnewAsAnotherWould) {
    const Scene scene = *builtin_scene("spheres");
    const RenderConfig config{.width = 24, .height = 16, .spp = 9};
    Renderer renderer(device(), scene, config);
    (void)renderer.render();
    renderer.restart(5);
    EXPECT_EQ(renderer.render().spp, 9u);
    EXPECT_TRUE(same_bits(renderer.image(), render_image(scene, {.width = 24, .height = 16, .spp = 9, .seed = 5})));
    renderer.restart(5, 3, 2);
    EXPECT_EQ(renderer.render().spp, 3u);
    EXPECT_TRUE(same_bits(renderer.image(),
                          render_image(scene, {.width = 24, .height = 16, .spp = 3, .max_depth = 2, .seed = 5})));
    renderer.restart(0, 9, config.max_depth);
    (void)renderer.render();
    EXPECT_TRUE(renderer.rebuild({.builder = Builder::high}));
    EXPECT_TRUE(same_bits(renderer.image(), render_image(scene, config)));
}

TEST(Renderer, RendersToAnErrorDoNotDependOnTheBatches) {
    const Scene scene = *builtin_scene("spheres");
    const auto spp_of = [&](unsigned paths) {
        const ScopedTuning tuning("render/wavefront", "PATHS", paths);
        Renderer renderer(device(), scene, {.width = 24, .height = 24, .spp = 1u << 20, .error = 0.05});
        return renderer.render().spp;
    };
    const unsigned spp = spp_of(1u << 20);
    EXPECT_GT(spp, 64u);
    for (const unsigned paths : {500u, 10'000u}) EXPECT_EQ(spp_of(paths), spp) << paths;
}

TEST(Renderer, AnImageWithoutNoiseHasNoError) {
    Scene scene;
    scene.materials = {lambert(1.f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 2, 0}, {0, 3, 0}, {0, 0, 1}, 30.f};  // away from it
    Renderer renderer(device(), scene, {.width = 16, .height = 16, .spp = 1u << 16, .error = 1e-4});
    const RenderProgress reached = renderer.render();
    EXPECT_EQ(reached.spp, 4u);
    EXPECT_GT(reached.error_bound, 0);
    EXPECT_LT(reached.error_bound, 1e-6);
}

TEST(Renderer, NoErrorIsToldOfABlackImage) {
    Scene scene = *builtin_scene("crate");
    scene.lights.clear(), scene.sky = {}, scene.environment = {};
    for (Material& material : scene.materials) material.emission = glm::vec3(0.f);
    Renderer renderer(device(), scene, {.width = 4, .height = 4, .spp = 1u << 24, .error = 0.1});
    EXPECT_TRUE(
        throws_error(ErrorKind::user, "the image is black after 2048 samples per pixel", [&] { renderer.render(); }));
}

TEST(Renderer, StopsAtTheTimeLimit) {
    Renderer renderer(device(), *builtin_scene("cornell"),
                      {.width = 64, .height = 64, .spp = 1'000'000, .seconds = 0.7});
    unsigned late = 0;
    const RenderProgress progress = renderer.render([&](const RenderProgress& p) {
        late += p.seconds >= 0.7;
        return true;
    });
    EXPECT_GE(progress.seconds, 0.7);
    EXPECT_LE(late, 1u) << "no pass begins after the limit";
    EXPECT_GE(progress.spp, 1u);
    EXPECT_LT(progress.spp, 1'000'000u);
}

TEST(Renderer, RendersForATime) {
    Renderer renderer(device(), *builtin_scene("cornell"), {.width = 64, .height = 64, .spp = 1'000'000});
    EXPECT_EQ(renderer.render_for(0).spp, 1u) << "every pixel has a sample";
    unsigned spp = 0;
    EXPECT_TRUE(becomes_true([&] {  // a busy machine may need several calls for a sample
        const auto begin = std::chrono::steady_clock::now();
        spp = renderer.render_for(0.3).spp;
        EXPECT_GE(seconds_since(begin), 0.3);
        return spp > 1;
    }));
    EXPECT_LT(spp, 1'000'000u);
    EXPECT_EQ(renderer.render_for(0).spp, spp) << "no time, no further samples";
    EXPECT_THROW((void)renderer.render_for(std::nan("")), Error);
}

TEST(Renderer, ReportsProgressAndStopsWhenAsked) {
    Renderer renderer(device(), *builtin_scene("cornell"), {.width = 64, .height = 64, .spp = 1'000'000});
    unsigned calls = 0, last_spp = 0;
    const RenderProgress progress = renderer.render([&](const RenderProgress& p) {
        EXPECT_GE(p.spp, last_spp);
        EXPECT_EQ(p.spp_target, 1'000'000u);
        EXPECT_GT(p.seconds, 0);
        last_spp = p.spp;
        return ++calls < 3;
    });
    EXPECT_EQ(calls, 3u);
    EXPECT_GE(progress.spp, 1u);
    EXPECT_LT(progress.spp, 1'000'000u);
}

TEST(Renderer, WritesItsImageIntoMemoryOfTheCaller) {
    const Scene scene = *builtin_scene("cornell");
    Renderer renderer(device(), scene, {.width = 641, .height = 480, .spp = 1});  // several parts
    renderer.render();
    for (const auto& [width, height] : {std::pair{641u, 480u}, std::pair{7u, 5u}}) {
        std::vector<glm::vec3> image(std::size_t(width) * height, glm::vec3(-1));
        renderer.image(image, width, height);
        EXPECT_EQ(image, renderer.image(width, height));
        const std::span<const glm::vec3> in_one_part = renderer.radiance(width, height);
        EXPECT_TRUE(std::equal(image.begin(), image.end(), in_one_part.begin(), in_one_part.end()));
    }
    std::vector<glm::vec3> small(641 * 479);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "307680 pixels does not fit", [&] { renderer.image(small); }));
}

TEST(Renderer, ScenesWithoutLightsTraceNoShadowRays) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    Renderer renderer(device(), scene, {.width = 32, .height = 32, .spp = 4});
    renderer.render();
    EXPECT_EQ(renderer.statistics().shadow.rays, 0u);
    EXPECT_EQ(renderer.statistics().shadow.milliseconds, 0.0);
}

TEST(Renderer, StatisticsCountEveryRay) {
    Scene scene;  // a floor that fills the view, a point light above: one shadow ray and one bounce a sample
    scene.materials = {lambert(1.f)};
    scene.meshes = {square(50.f, 0.f)};
    scene.lights = {point_light({0, 3, 0}, glm::vec3(1.f))};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 2, 0}, {0, 0, 0}, {0, 0, 1}, 30.f};
    Renderer renderer(device(), scene, {.width = 33, .height = 17, .spp = 5});
    renderer.render();
    const RenderStatistics statistics = renderer.statistics();
    EXPECT_EQ(statistics.camera.rays, 33u * 17 * 5);
    EXPECT_EQ(statistics.bounce.rays, 33u * 17 * 5);
    EXPECT_EQ(statistics.shadow.rays, 33u * 17 * 5);
    EXPECT_GT(statistics.camera.milliseconds, 0);
    EXPECT_GT(statistics.build_milliseconds, 0);
    EXPECT_EQ(statistics.bvh.triangles, 2u);
    EXPECT_GT(statistics.device_bytes, 33u * 17 * 44);
    EXPECT_EQ(statistics.dropped_samples, 0u);
}

TEST(Renderer, TakesNoMoreMemoryThanItsBatches) {
    const Scene scene = *builtin_scene("spheres");
    Renderer renderer(device(), scene, {.width = 16, .height = 16, .spp = 256});
    const auto bytes = [&] { return renderer.statistics().device_bytes; };
    const std::uint64_t none = bytes();
    (void)renderer.render([](const RenderProgress&) { return false; });
    const std::uint64_t first = bytes();
    (void)renderer.render();
    const std::uint64_t all = bytes();
    EXPECT_GT(first, none);
    EXPECT_LT(first, none + 256 * 400);
    EXPECT_GT(all, none + 4096 * 100);
    renderer.restart(1);
    (void)renderer.render();
    EXPECT_GE(bytes(), all);
}

TEST(Renderer, SamplesThatOverflowAreDroppedAndCounted) {
    Scene scene;
    scene.materials = {lambert(0.5f), emitter(3e38f)};
    scene.meshes = {square(5.f, 0.f), square(1.f, 1.f, 1)};
    scene.camera = Camera{{0, 0.9f, 3}, {0, 0, 0}, {0, 1, 0}, 40.f};
    Renderer renderer(device(), scene, {.width = 16, .height = 16, .spp = 4});
    renderer.render();
    EXPECT_GT(renderer.statistics().dropped_samples, 100u);
    for (const glm::vec3& pixel : renderer.image())
        EXPECT_TRUE(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
}

/// As an image is: by several threads, from memory that the device shares or has page-locked.
TEST(Renderer, LargeResultsAreReadBackInParts) {
    const ScopedTuning tuning("render/wavefront", "PATHS", 600 * 600);  // as many at once as GPUs have
    Renderer renderer(device(), *builtin_scene("spheres"), {.width = 600, .height = 600, .spp = 1});
    (void)renderer.aovs();
    Profiler& profiler = device().profiler();
    profiler.enable(true);
    const auto reads = [&] {
        return profiler.summary().contains("read_buffer") ? profiler.summary().at("read_buffer").count : 0;
    };
    const auto before = reads();
    (void)renderer.aovs(), (void)renderer.gbuffer(), (void)renderer.noise_map();
    const auto large = reads() - before;
    profiler.enable(false);
    EXPECT_EQ(large, 1u) << "the sums of the film alone: others took a thread twenty times as long on an H200";
}

TEST(Renderer, AovsAreOfThePixelCentres) {
    Scene scene;
    scene.materials = {lambert(0.25f), lambert(0.75f)};
    scene.meshes = {square(1.f, 0.f, 1)};
    scene.meshes[0].normals.assign(4, glm::normalize(glm::vec3(0.1f, 1.f, 0.f)));
    scene.camera = Camera{{0, 4, 0}, {0, 0, 0}, {0, 0, -1}, 53.13010235f};  // half the image's height is 2 on the plane
    const ScopedTuning tuning("render/wavefront", "PATHS", 50);             // several batches
    const Aovs aovs = Renderer(device(), scene, {.width = 16, .height = 8, .spp = 1}).aovs();
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x) {
            const double px = (x + 0.5 - 8) * 0.5, pz = (y + 0.5 - 4) * 0.5;
            const std::size_t i = std::size_t(y) * 16 + x;
            if (std::abs(px) > 1 || std::abs(pz) > 1) {
                EXPECT_EQ(aovs.primitive[i], CLARAY_MISS);
                EXPECT_EQ(aovs.material[i], CLARAY_MISS);
                EXPECT_EQ(aovs.depth[i], std::numeric_limits<float>::infinity());
                EXPECT_EQ(aovs.normal[i], glm::vec3(0));
                continue;
            }
            EXPECT_LT(aovs.primitive[i], 2u);
            EXPECT_NEAR(aovs.depth[i], std::sqrt(px * px + pz * pz + 16), 1e-5);
            EXPECT_NEAR(glm::distance(aovs.normal[i], scene.meshes[0].normals[0]), 0, 1e-6);
            EXPECT_EQ(aovs.albedo[i], glm::vec3(0.75f));
            EXPECT_EQ(aovs.material[i], 1u);
            EXPECT_GT(aovs.heat[i], 0u);
        }
}

/// Denoisers take the albedo for the surface's colour: a black lamp would be smeared.
TEST(Renderer, TheAlbedoOfLampsIsTheirLight) {
    Scene scene;
    scene.materials = {emitter(17.f), lambert(0.5f)};
    scene.materials[0].albedo = glm::vec3(0.f);
    scene.meshes = {square(9.f, 0.f)};
    scene.camera = Camera{{0, 4, 0}, {0, 0, 0}, {0, 0, -1}, 40.f};
    const auto albedo = [&] { return Renderer(device(), scene, {.width = 2, .height = 2, .spp = 1}).aovs().albedo; };
    EXPECT_EQ(albedo()[0], glm::vec3(1.f));
    scene.materials[0].emission = {0.5f, 0.25f, 3.f}, scene.materials[0].albedo = glm::vec3(0.25f);
    EXPECT_EQ(albedo()[0], glm::vec3(0.75f, 0.5f, 1.f));
    Texture half;  // an image of which the right is black
    half.width = 2, half.height = 1, half.channels = 3, half.format = TexelFormat::linear8,
    half.filter = Filter::nearest;
    half.bytes = {255, 255, 255, 0, 0, 0};
    scene.textures = {half};
    scene.materials[0].emission_map.texture = 0;
    scene.meshes[0].uvs = {{0, 0}, {1, 0}, {1, 0}, {0, 0}};
    const std::vector<glm::vec3> sides = albedo();
    EXPECT_EQ(sides[0], glm::vec3(0.75f, 0.5f, 1.f));
    EXPECT_EQ(sides[1], glm::vec3(0.25f));
}

/// Edges that nearly agree: a plain cross product would be off by a hundredth.
TEST(Renderer, SliversHaveTheirNormals) {
    const glm::vec3 e1(0.7f, 1.1f, 1.3f), e2 = 0.99f * e1 + glm::vec3(0, 0, 1e-5f);
    const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(e1), glm::dvec3(e2)));
    Scene scene;
    scene.materials = {lambert(0.5f)};
    Mesh sliver;
    sliver.positions = {glm::vec3(0), e1, e2};
    sliver.triangles = {{0, 1, 2}};
    scene.meshes = {sliver};
    const glm::dvec3 middle = (glm::dvec3(e1) + glm::dvec3(e2)) / 3.0;
    scene.camera = narrow_camera(glm::vec3(middle + normal), glm::vec3(middle));
    const Aovs aovs = Renderer(device(), scene, {.width = 1, .height = 1, .spp = 1}).aovs();
    ASSERT_EQ(aovs.primitive[0], 0u);
    EXPECT_LT(glm::distance(glm::dvec3(aovs.normal[0]), normal), 1e-6);
}

TEST(Renderer, EmptySceneShowsTheSky) {
    Scene scene;
    scene.sky = {glm::vec3(0.5f), glm::vec3(0.5f)};
    for (const glm::vec3& pixel : render_image(scene, {.width = 4, .height = 4, .spp = 2})) EXPECT_EQ(pixel.x, 0.5f);
}

TEST(Renderer, RefusesBadConfigurations) {
    const Scene scene = *builtin_scene("cornell");
    const auto refused = [&](const RenderConfig& config, const char* words) {
        return throws_error(ErrorKind::usage, words, [&] { Renderer(device(), scene, config); });
    };
    EXPECT_TRUE(refused({.width = 0}, "image size 0x512"));
    EXPECT_TRUE(refused({.height = 0}, "image size 512x0"));
    EXPECT_TRUE(refused({.width = 16385}, "16384"));
    EXPECT_TRUE(refused({.spp = 0}, "samples"));
    EXPECT_TRUE(refused({.max_depth = 0}, "depth"));
    EXPECT_TRUE(refused({.seconds = -1}, "time"));
    EXPECT_TRUE(refused({.noise = std::nan("")}, "noise"));
    EXPECT_TRUE(refused({.error = -0.1}, "error"));
    EXPECT_TRUE(refused({.error = std::nan("")}, "error"));
    EXPECT_TRUE(refused({.checkpoint_seconds = 0}, "time between checkpoints"));
    Scene broken = scene;
    broken.materials[0].albedo.x = std::nanf("");
    EXPECT_TRUE(throws_error(ErrorKind::user, "albedo", [&] { Renderer(device(), broken, {}); }));
}

}  // namespace
}  // namespace claray::test
