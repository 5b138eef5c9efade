// Renderer::denoised, and the guides that it traces: render/write_guides.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <span>

#include "claray/renderer.hpp"
#include "claray/scene.hpp"
#include "claray/shared/denoise.h"
#include "host/compute/memory.hpp"
#include "host/denoise/oidn.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

using Image = std::vector<glm::vec3>;
constexpr unsigned side = 48;

double rms_between(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += double(glm::dot(a[i] - b[i], a[i] - b[i]));
    return std::sqrt(sum / (3 * double(a.size())));
}

double mean_of(const Image& image) {
    double sum = 0;
    for (const glm::vec3& p : image) sum += double(p.x) + double(p.y) + double(p.z);
    return sum / (3 * double(image.size()));
}

/// Of the Cornell box, whose renderer the tests share.
struct Box {
    Renderer renderer{device(), *builtin_scene("cornell"), {.width = side, .height = side, .spp = 1024}};
    Image reference = [this] {
        render(1024, 77);
        return renderer.image();
    }();
    void render(unsigned spp, std::uint32_t seed) {
        renderer.restart(seed, spp);
        (void)renderer.render();
    }
};
Box& box() {
    static Box box;
    return box;
}

TEST(DenoisedStills, HaveLessThanHalfTheErrorWithFewSamples) {
    for (const unsigned spp : {1u, 4u, 16u}) {
        box().render(spp, 5);
        const double before = rms_between(box().renderer.image(), box().reference);
        const Image image = box().renderer.denoised(DenoiserKind::claray);
        EXPECT_LT(rms_between(image, box().reference), before / 2) << spp << " samples";
        EXPECT_EQ(image, box().renderer.denoised(DenoiserKind::claray)) << "differs from run to run";
    }
}

TEST(DenoisedStills, AreNotWorseWithManySamples) {
    box().render(256, 6);
    const double before = rms_between(box().renderer.image(), box().reference);
    EXPECT_LT(rms_between(box().renderer.denoised(DenoiserKind::claray), box().reference), 1.02 * before);
}

TEST(DenoisedStills, KeepTheMean) {
    box().render(4, 9);
    EXPECT_NEAR(mean_of(box().renderer.denoised(DenoiserKind::claray)) / mean_of(box().reference), 1, 0.03);
}

/// The denoiser leaves alone what cameras see of lamps. Glass around them and fog before them belong to it.
TEST(DenoisedStills, ShowLampsInGlassAndInFogAsTheFilmDoes) {
    Scene lamp_in_glass = *builtin_scene("effect:nested-media"), foggy = *builtin_scene("cornell");
    lamp_in_glass.materials.emplace_back().emission = glm::vec3(5.f);
    for (std::uint32_t& material : lamp_in_glass.meshes.back().materials) material = 3;  // the ball in the glass
    foggy.sky.fog_color = {0.6f, 0.65f, 0.7f}, foggy.sky.fog_density = 0.3f;
    for (const Scene& scene : {lamp_in_glass, foggy}) {
        Renderer renderer(device(), scene, {.width = side, .height = side, .spp = 1024});
        (void)renderer.render();
        const Image reference = renderer.image();
        renderer.restart(5, 64);
        (void)renderer.render();
        EXPECT_LT(rms_between(renderer.denoised(DenoiserKind::claray), reference),
                  0.8 * rms_between(renderer.image(), reference));
    }
}

/// A lamp in the upper half, and a mirror below it in the lower half that shows it: nothing is reflected by rough
/// surfaces.
Scene lamp_and_mirror() {
    Scene scene;
    Material lamp, mirror;
    lamp.albedo = glm::vec3(0), lamp.emission = {7, 5, 3};
    mirror.kind = MaterialKind::mirror, mirror.albedo = {0.5f, 0.6f, 0.7f};
    scene.materials = {lamp, mirror};
    Mesh above, below;
    above.positions = {{-0.7f, 0.1f, 0}, {0.6f, 0.1f, 0}, {-0.1f, 1.2f, 0}}, above.triangles = {{0, 1, 2}};
    below.positions = {{-2, 0, 2}, {2, 0, 2}, {2, 0, -3}, {-2, 0, -3}};
    below.triangles = {{0, 1, 2}, {0, 2, 3}}, below.materials = {1, 1};
    scene.meshes = {above, below};
    Camera camera;
    camera.position = {0, 0.4f, 3};
    scene.camera = camera;
    return scene;
}

Image half(const Image& image, bool lower) {
    const auto middle = image.begin() + side * side / 2;
    return lower ? Image(middle, image.end()) : Image(image.begin(), middle);
}

/// Its noise is that of coverage alone, which the guides know from the same samples.
TEST(DenoisedStills, LampsSeenDirectlyOrInMirrorsOnlyGain) {
    Renderer renderer(device(), lamp_and_mirror(), {.width = side, .height = side, .spp = 1024, .seed = 3});
    (void)renderer.render();
    const Image reference = renderer.image();
    for (const unsigned spp : {1u, 3u}) {
        renderer.restart(8, spp);
        (void)renderer.render();
        const Image noisy = renderer.image(), denoised = renderer.denoised(DenoiserKind::claray);
        for (const bool mirrored : {false, true}) {
            const double before = rms_between(half(noisy, mirrored), half(reference, mirrored));
            const double after = rms_between(half(denoised, mirrored), half(reference, mirrored));
            EXPECT_LT(after, before / 2) << spp << " samples, " << mirrored;
        }
        double largest = 0;  // of pixels without an edge
        for (std::size_t i = 0; i < noisy.size(); ++i)
            if (noisy[i] == glm::vec3(7, 5, 3) && reference[i] == noisy[i])
                largest = std::max(largest, double(glm::length(denoised[i] - noisy[i])));
        EXPECT_LT(largest, 1e-4);
    }
}

/// A sheet of rough metal that shows a small lamp behind the camera: a highlight, and nothing else.
Scene highlight() {
    Scene scene;
    Material lamp, metal;
    lamp.albedo = glm::vec3(0), lamp.emission = glm::vec3(40);
    metal.kind = MaterialKind::metal, metal.albedo = {0.9f, 0.7f, 0.3f}, metal.roughness = 0.2f;
    scene.materials = {lamp, metal};
    Mesh behind, sheet;
    behind.positions = {{-0.3f, 0.8f, 5}, {0.3f, 0.8f, 5}, {0.3f, 1.4f, 5}, {-0.3f, 1.4f, 5}};
    sheet.positions = {{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}};
    behind.triangles = sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    sheet.materials = {1, 1};
    scene.meshes = {behind, sheet};
    scene.camera = Camera{{0, 0, 4}, {0, 0.3f, 0}, {0, 1, 0}, 50.f};
    return scene;
}

/// Guides know most of its light from many more rays than the film has.
TEST(DenoisedStills, HighlightsInRoughMetalStaySharp) {
    Renderer renderer(device(), highlight(), {.width = side, .height = side, .spp = 1024, .seed = 3});
    (void)renderer.render();
    const Image reference = renderer.image();
    renderer.restart(8, 1);
    (void)renderer.render();
    const double before = rms_between(renderer.image(), reference);
    EXPECT_LT(rms_between(renderer.denoised(DenoiserKind::claray), reference), 0.45 * before);
}

/// Slanted strips of two colours under an even sky: all noise is that of their borders.
Scene strips() {
    Scene scene;
    Material dark, bright;
    dark.albedo = glm::vec3(0.1f), bright.albedo = glm::vec3(0.9f);
    scene.materials = {dark, bright};
    Mesh sheet;
    for (std::uint32_t i = 0; i < 40; ++i) {
        const float left = -4 + 0.2f * float(i);
        for (const float x : {left, left + 0.2f})
            sheet.positions.insert(sheet.positions.end(), {{x - 0.5f, -3, 0}, {x + 0.5f, 3, 0}});
        sheet.triangles.insert(sheet.triangles.end(), {{4 * i, 4 * i + 2, 4 * i + 3}, {4 * i, 4 * i + 3, 4 * i + 1}});
        sheet.materials.insert(sheet.materials.end(), 2, i % 2);
    }
    scene.meshes = {sheet};
    scene.sky = {glm::vec3(1), glm::vec3(1)};
    scene.camera = Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 50.f};
    return scene;
}

/// Guides have fewer rays than the film has samples, and therefore noisier borders.
TEST(DenoisedStills, BordersOfColorsAreNotWorseWithManySamples) {
    Renderer renderer(device(), strips(), {.width = side, .height = side, .spp = 1024, .seed = 3});
    (void)renderer.render();
    const Image reference = renderer.image();
    renderer.restart(8, 64);
    (void)renderer.render();
    EXPECT_LT(rms_between(renderer.denoised(DenoiserKind::claray), reference),
              1.02 * rms_between(renderer.image(), reference));
}

/// The guide of a pixel from rays of these luminances of albedo, glow and gloss, for a film of `in_film` samples.
/// `before`: of earlier rays, to which these are added.
Guide guide_of(const std::vector<glm::vec3>& rays, std::uint32_t in_film, const Guide& before = {}) {
    std::vector<Sight> sights;
    for (const glm::vec3& ray : rays) {
        Sight sight{};
        sight.albedo_r = sight.albedo_g = sight.albedo_b = ray.x, sight.normal_z = ray.x;
        sight.glow_r = sight.glow_g = sight.glow_b = ray.y, sight.gloss_r = sight.gloss_g = sight.gloss_b = ray.z;
        sights.push_back(sight);
    }
    GuideStep step{};
    step.step.batch.pixels = 1, step.listed = 1, step.run_count = 1;
    FilmPixel pixel{};
    pixel.count = in_film;
    const Buffer<Guide> guide(device(), std::vector{before});
    const Buffer<GuideRun> runs(device(), std::vector{GuideRun{0, 0, std::uint32_t(rays.size())}});
    const bool cpu = device().info().type == DeviceType::cpu;
    load_kernel(device(), "render/write_guides.cl", "write_guides")
        .run(cpu ? Range{1, 1} : Range{CLARAY_LANES_OF_EDGE, CLARAY_GUIDE_GROUP}, step, runs,
             Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{0, before.rays}),
             Buffer<FilmPixel>(device(), std::vector{pixel}), Buffer<Sight>(device(), sights), guide,
             Buffer<Glow>(device(), 1));
    return guide.read()[0];
}

TEST(Guides, OfFurtherRaysAreThoseOfAllRays) {
    const std::vector<glm::vec3> rays = {{0.1f, 0, 1}, {0.3f, 4, 2}, {0.2f, 1, 0}, {0.7f, 8, 3}, {0.5f, 2, 9}};
    const Guide first = guide_of({rays.begin(), rays.begin() + 2}, 2), all = guide_of(rays, 2);
    const Guide both = guide_of({rays.begin() + 2, rays.end()}, 2, first);
    EXPECT_EQ(both.rays, 5u);
    EXPECT_NEAR(both.albedo_g, all.albedo_g, 1e-6);
    EXPECT_NEAR(both.glow_b, all.glow_b, 1e-5);
    EXPECT_NEAR(both.gloss_r, all.gloss_r, 1e-5);
    EXPECT_NEAR(both.normal_z, all.normal_z, 1e-6);
    EXPECT_NEAR(both.ray_variance, all.ray_variance, 1e-4);
    EXPECT_NEAR(all.ray_variance, 20, 1e-3) << "of 1, 6, 1, 11, 11";
    EXPECT_EQ(both.sampled_glow_r, all.sampled_glow_r) << "the film's samples are the first rays";
    EXPECT_EQ(both.odd_glow, all.odd_glow);
}

/// Adaptive films have pixels of more samples than the first rays at edges.
TEST(Guides, OfPartOfTheFilmKeepTheirRays) {
    const std::vector<glm::vec3> rays = {{0.1f, 0, 1}, {0.3f, 4, 2}, {0.2f, 1, 0}, {0.7f, 8, 3}, {0.5f, 2, 9}};
    for (const std::uint32_t in_film : {3u, 4u, 5u, 9u})
        for (const int first : {1, 2, 3}) {
            const Guide all = guide_of(rays, in_film), part = guide_of({rays.begin(), rays.begin() + first}, in_film);
            const Guide both = guide_of({rays.begin() + first, rays.end()}, in_film, part);
            EXPECT_EQ(part.complete, std::uint32_t(first) >= in_film);
            EXPECT_EQ(both.complete, in_film <= 5);
            EXPECT_EQ(both.rays, 5u);
            EXPECT_NEAR(both.albedo_g, all.albedo_g, 1e-6);
            EXPECT_NEAR(both.sampled_albedo_g, all.sampled_albedo_g, 1e-6) << in_film << ' ' << first;
            EXPECT_NEAR(both.sampled_glow_b, all.sampled_glow_b, 1e-5) << in_film << ' ' << first;
            EXPECT_NEAR(both.odd_glow, all.odd_glow, 1e-5) << in_film << ' ' << first;
        }
}

TEST(Guides, AreTheSameInSmallerBatches) {
    const auto denoised = [] {
        Renderer renderer(device(), *builtin_scene("cornell"), {.width = 96, .height = 64, .spp = 4});
        (void)renderer.render();
        return renderer.denoised(DenoiserKind::claray);
    };
    const std::vector<glm::vec3> expected = denoised();
    const ScopedTuning paths("render/wavefront", "PATHS", 4096);  // fewer than the four rays of each pixel
    EXPECT_EQ(denoised(), expected);
}

/// The classes of a row of pixels.
std::vector<std::uint8_t> classes_of(const std::vector<Glow>& glows) {
    const auto width = std::uint32_t(glows.size());
    const Buffer<std::uint8_t> classes(device(), glows.size());
    Buffer<std::uint32_t> counts(device(), CLARAY_EDGE_CLASSES);
    counts.fill(0);
    load_kernel(device(), "render/write_guides.cl", "find_edges")
        .run({glows.size(), 64}, width, 1u, Buffer<Glow>(device(), glows), classes, counts);
    return classes.read();
}

/// Four rays of each of two neighbours, one of which sees a lamp and the other does not, may have missed the border
/// between them. Many rays have not.
TEST(Guides, PixelsBesideABorderGetMoreRays) {
    constexpr std::uint8_t none = CLARAY_EDGE_CLASSES;
    std::vector<Glow> row;
    for (int i = 0; i < 8; ++i) row.push_back({i < 4 ? 0.f : 16.f, 0, 4});
    std::vector<std::uint8_t> classes = classes_of(row);
    for (std::size_t i = 0; i < row.size(); ++i) EXPECT_EQ(classes[i] == none, i != 3 && i != 4) << i;
    row[4].rays = 400;
    classes = classes_of(row);
    EXPECT_NE(classes[3], none);
    EXPECT_EQ(classes[4], none);
}

/// Classes are by the variance of a ray, a factor of 2 each: of the pixel's own if it has many, of its neighbours if
/// not.
TEST(Guides, PixelsAreSortedByTheNoiseOfARay) {
    std::vector<Glow> row(9, {0, 3, 4000});
    EXPECT_EQ(classes_of(row)[4], CLARAY_EDGE_CLASSES / 2 + 1);
    row[4].variance = 3 * 64;
    EXPECT_EQ(classes_of(row)[4], CLARAY_EDGE_CLASSES / 2 + 7);
    EXPECT_EQ(classes_of(row)[3], CLARAY_EDGE_CLASSES / 2 + 1);
    row[3].rays = 4;
    EXPECT_EQ(classes_of(row)[3], CLARAY_EDGE_CLASSES / 2 + 6) << "the mean of 3, 3 and 192";
}

/// Rays that are all of the film's samples have its albedo and glow. Some of its samples have less noise than they, and
/// their gloss is not the film's.
TEST(DenoisedStills, GuidesTellTheVarianceThatTheFilmHasNot) {
    const std::vector<glm::vec3> rays = {{0.1f, 0, 1}, {0.3f, 4, 2}, {0.1f, 0, 3}, {0.3f, 4, 6}};
    const Guide all = guide_of(rays, 4), some = guide_of(rays, 16);
    EXPECT_TRUE(all.complete);
    EXPECT_NEAR(all.gloss_variance, 3.5 / 3, 1e-5);
    EXPECT_NEAR(some.albedo_variance, 0.01 / 3, 1e-6);
    EXPECT_NEAR(some.glow_variance, 4. / 3, 1e-5);
    EXPECT_FALSE(some.complete);
}

/// Their device has its own count of memory.
TEST(DenoisedStills, KeepTheirMemoryUntilItIsReleased) {
    const Device own = Device::open(std::to_string(device().info().index));
    Renderer renderer(own, *builtin_scene("cornell"), {.width = side, .height = side, .spp = 4});
    (void)renderer.render();
    const Image noisy = renderer.image();
    const auto counted = [&] { return renderer.statistics().device_bytes; };
    const std::uint64_t counted_before = counted(), before = bytes_in_use(own);
    const Image first = renderer.denoised(DenoiserKind::claray);
    EXPECT_GT(bytes_in_use(own), before);
    EXPECT_EQ(counted() - counted_before, bytes_in_use(own) - before) << "statistics count all of it";
    fail_allocation(own, 1);
    EXPECT_EQ(renderer.denoised(DenoiserKind::claray), first) << "nothing is made twice";
    fail_allocation(own, 0);
    renderer.release_denoiser();
    EXPECT_EQ(bytes_in_use(own), before);
    EXPECT_EQ(counted(), counted_before);
    EXPECT_EQ(renderer.denoised(DenoiserKind::claray), first);
    EXPECT_EQ(renderer.image(), noisy);
}

/// What is kept from one denoised image to the next does not outlive its scene and its size.
TEST(DenoisedStills, AreThoseOfANewRendererAfterChanges) {
    Scene scene = lamp_and_mirror();
    const RenderConfig config{.width = side, .height = side, .spp = 4, .seed = 3};
    const auto anew = [&](unsigned width) {
        RenderConfig wide = config;
        wide.width = width;
        Renderer renderer(device(), scene, wide);
        (void)renderer.render();
        return renderer.denoised(DenoiserKind::claray);
    };
    Renderer renderer(device(), scene, config);
    (void)renderer.render();
    EXPECT_EQ(renderer.denoised(DenoiserKind::claray), anew(side));
    scene.materials[1].albedo = {0.2f, 0.5f, 0.9f};
    for (glm::vec3& position : scene.meshes[1].positions) position.y -= 0.3f;
    renderer.update(scene, {.materials = true, .vertices = true});
    (void)renderer.render();
    EXPECT_EQ(renderer.denoised(DenoiserKind::claray), anew(side));
    renderer.resize(side + 9, side);
    (void)renderer.render();
    EXPECT_EQ(renderer.denoised(DenoiserKind::claray), anew(side + 9));
}

/// Lamp and mirror before a rough wall under a sun, as instances.
Scene instances_under_a_sun() {
    Scene scene = lamp_and_mirror();
    Mesh wall;
    wall.positions = {{-4, -2, -2}, {4, -2, -2}, {4, 4, -2}, {-4, 4, -2}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}}, wall.materials = {2, 2};
    scene.materials.emplace_back();
    scene.meshes.push_back(wall);
    for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) scene.instances.push_back({mesh, glm::mat4(1.f)});
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {0.3f, -0.5f, -1};
    scene.lights = {sun};
    return scene;
}

struct SceneStep {
    const char* name;
    SceneChanges changes;
    std::function<void(Scene&)> apply;
    bool forgets = false;  // the frames before
};

const std::vector<SceneStep>& scene_steps() {
    static const std::vector<SceneStep> steps = {
        {"lights", {.lights = true}, [](Scene& s) { s.lights[0].intensity = glm::vec3(5, 3, 1); }, true},
        {"sky",
         {.sky = true},
         [](Scene& s) {
             s.sky = {glm::vec3(0.2f), glm::vec3(0.5f, 0.7f, 1)};
         },
         true},
        {"materials",
         {.materials = true},
         [](Scene& s) {
             s.materials[2].albedo = {0.9f, 0.3f, 0.2f};
         },
         true},
        {"a new effect, whose kernels are adopted",
         {.materials = true},
         [](Scene& s) { s.materials[2].kind = MaterialKind::metal, s.materials[2].roughness = 0.2f; },
         true},
        {"a second lamp, which light tables hold",
         {.materials = true},
         [](Scene& s) {
             s.materials[1].emission = {1, 2, 3};
         },
         true},
        {"a point light",
         {.lights = true},
         [](Scene& s) {
             s.lights.push_back({.position = {0, 2, 1}});
         },
         true},
        {"instances",
         {.instances = true},
         [](Scene& s) {
             s.instances[0].transform[3] = {0.3f, 0.2f, 0, 1};
         }},
        {"vertices",
         {.vertices = true},
         [](Scene& s) {
             for (glm::vec3& position : s.meshes[1].positions) position.y -= 0.2f;
         }},
        {"camera", {.camera = true}, [](Scene& s) { s.camera->position.x = 0.4f; }}};
    return steps;
}

/// Frames after a change of light are those of a new renderer, too: they hold nothing of the frames before.
TEST(DenoisedStills, FollowEachChangeOfTheScene) {
    Scene scene = instances_under_a_sun();
    const RenderConfig config{.width = side, .height = side, .spp = 4, .seed = 3};
    const auto picture = [](Renderer& of) {
        const std::span<const std::uint8_t> bytes = of.denoised_picture();
        return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
    };
    Renderer renderer(device(), scene, config);
    (void)renderer.render();
    Image last = renderer.denoised(DenoiserKind::claray);
    (void)picture(renderer);
    for (const SceneStep& step : scene_steps()) {
        step.apply(scene);
        renderer.update(scene, step.changes);
        (void)renderer.render();
        Renderer anew(device(), scene, config);
        (void)anew.render();
        const Image image = renderer.denoised(DenoiserKind::claray);
        EXPECT_EQ(image, anew.denoised(DenoiserKind::claray)) << step.name;
        EXPECT_NE(image, last) << step.name << " changes nothing";
        last = image;
        const std::vector<std::uint8_t> frame = picture(renderer);
        if (step.forgets) {
            EXPECT_EQ(frame, picture(anew)) << step.name;
        }
    }
}

TEST(DenoisedStills, AnAbsentLibraryIsNamed) {
    const char* before = std::getenv("CLARAY_OIDN");
    const std::string kept = before ? before : "";
    setenv("CLARAY_OIDN", "/no/such/library.so", 1);
    EXPECT_EQ(picked_denoiser(DenoiserKind::automatic), DenoiserKind::claray);
    EXPECT_TRUE(throws_error(ErrorKind::user, "/no/such/library.so", [] { require_oidn(); }));
    before ? setenv("CLARAY_OIDN", kept.c_str(), 1) : unsetenv("CLARAY_OIDN");
}

TEST(DenoisedStills, OpenImageDenoiseIsUsedIfInstalled) {
    if (!Oidn::load()) GTEST_SKIP() << "Open Image Denoise is not installed";
    box().render(4, 5);
    const double before = rms_between(box().renderer.image(), box().reference);
    EXPECT_LT(rms_between(box().renderer.denoised(DenoiserKind::oidn), box().reference), before / 2);
}

}  // namespace
}  // namespace claray::test
