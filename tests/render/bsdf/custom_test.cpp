// BSDFs that a program adds: claray/scene.hpp, kernels/bsdf/custom.clh.
#include <gtest/gtest.h>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

/// claray's Lambertian, times a parameter.
const char* const paint = R"(
static inline float3 eval_paint(const MaterialData* material, const BsdfView* view, float3 incoming, float* pdf) {
    const float cosine = fmax(incoming.z, 0.0f);
    *pdf = cosine * INV_PI;
    return parameters_of(material, view)[1] * albedo_of(material) * (cosine * INV_PI);
}
static inline bool sample_paint(const MaterialData* material, const BsdfView* view, float3 random, BsdfSample* sample) {
    sample->incoming = sample_cosine(random.xy);
    return weigh_later(sample);
}
static inline bool is_delta_paint(const MaterialData* material) { return false; }
)";
/// Half of it, and without parameters.
const char* const dull = R"(
static inline float3 eval_dull(const MaterialData* material, const BsdfView* view, float3 incoming, float* pdf) {
    *pdf = fmax(incoming.z, 0.0f) * INV_PI;
    return 0.5f * albedo_of(material) * *pdf;
}
static inline bool sample_dull(const MaterialData* material, const BsdfView* view, float3 random, BsdfSample* sample) {
    sample->incoming = sample_cosine(random.xy);
    return weigh_later(sample);
}
static inline bool is_delta_dull(const MaterialData* material) { return false; }
)";

std::uint32_t added_paint() {
    static const std::uint32_t number = add_bsdf({.name = "paint", .source = paint, .parameters = 2});
    return number;
}

/// Two placed balls on a floor under a lamp and an environment: shadow rays and scattered ones find both.
Scene lit_balls(const Material& first, const Material& second) {
    Scene scene = *builtin_scene("effect:instances");
    scene.materials[0] = first, scene.materials[1] = second;
    Texture image;
    image.width = 2, image.height = 1, image.channels = 3, image.format = TexelFormat::float32;
    image.floats = {0.5f, 0.6f, 0.7f, 1.5f, 1.2f, 1.f};
    scene.environment.images = {image};
    return scene;
}

Material custom(std::uint32_t number, std::vector<float> parameters) {
    Material m = material(MaterialKind::custom, 0.8f, 0.4f);
    m.name = "mine", m.custom = number, m.parameters = std::move(parameters);
    return m;
}

TEST(CustomBsdf, RendersAsClaraysOwn) {
    const RenderConfig config{.width = 48, .height = 32, .spp = 64};
    const auto expected = mean(render_by_own_kernels(lit_balls(lambert(0.8f), lambert(0.4f)), config));
    const std::uint32_t number = added_paint();
    const Scene scene = lit_balls(custom(number, {7.f, 1.f}), custom(number, {7.f, 0.5f}));
    EXPECT_TRUE(effects_of(scene).has(Effect::custom));
    const auto found = mean(render_by_own_kernels(scene, config));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1, 1e-4) << c;
}

TEST(CustomBsdf, OfSeveralTheMaterialChooses) {
    const RenderConfig config{.width = 48, .height = 32, .spp = 64};
    const auto expected = mean(render_by_own_kernels(lit_balls(lambert(0.8f), lambert(0.4f)), config));
    const std::uint32_t first = added_paint(), second = add_bsdf({.name = "dull", .source = dull});
    const auto found = mean(render_by_own_kernels(lit_balls(custom(first, {7.f, 1.f}), custom(second, {})), config));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1, 1e-4) << c;
}

TEST(CustomBsdf, RefusesWhatDoesNotFit) {
    const std::uint32_t number = added_paint();
    EXPECT_TRUE(throws_error(ErrorKind::usage, "is not a name", [] { add_bsdf({.name = "no name", .source = ""}); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "already", [] { add_bsdf({.name = "metal", .source = ""}); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "already", [] { add_bsdf({.name = "paint", .source = ""}); }));
    const auto render = [](const Material& m) {
        (void)render_image(lit_balls(m, lambert(0.5f)), {.width = 4, .height = 4, .spp = 1});
    };
    EXPECT_TRUE(
        throws_error(ErrorKind::user, "material 'mine' has 1 parameters", [&] { render(custom(number, {1.f})); }));
    EXPECT_TRUE(throws_error(ErrorKind::user, "number 99", [&] { render(custom(99, {})); }));
}

}  // namespace
}  // namespace claray::test
