// Cut-outs and back faces in traversal (trace/cutout.clh, trace/cutouts.cl): against a float64 brute force with the
// same opacity, and as seen in images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "claray/query.hpp"
#include "claray/shared/rng.h"
#include "host/bvh/bvh_state.hpp"
#include "host/bvh/instances_state.hpp"
#include "host/textures/textures.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

/// Triangles of seven materials: solid, masked by an image's alpha, masked by a red channel on the second set, blended
/// by both, without a back, masked below
/// the cut-off by the corners' own alpha, and blended by that and by an image's. The second of two
/// meshes has no colours.
Scene mixed_soup(std::size_t count) {
    Scene scene;
    scene.textures = {random_texture({16, 16}, 4, TexelFormat::srgb8, 1),
                      random_texture({9, 7}, 1, TexelFormat::linear8, 2)};
    scene.textures[0].wrap_u = Wrap::mirror;
    scene.materials.assign(7, lambert_material());
    scene.materials[1].alpha_mode = AlphaMode::mask, scene.materials[1].albedo_map.texture = 0;
    scene.materials[1].albedo_map.rotation = 0.3f, scene.materials[1].albedo_map.offset = {0.2f, 0.7f};
    scene.materials[2].alpha_mode = AlphaMode::mask, scene.materials[2].opacity_map = {.texture = 1, .uv_set = 1};
    scene.materials[2].alpha_cutoff = 0.3f, scene.materials[2].cull_back = true;
    scene.materials[3].alpha_mode = AlphaMode::blend, scene.materials[3].albedo_map.texture = 0;
    scene.materials[3].opacity_map.texture = 1, scene.materials[3].opacity = 0.9f;
    scene.materials[4].cull_back = true;
    scene.materials[5].alpha_mode = AlphaMode::mask, scene.materials[5].opacity = 0.8f;
    scene.materials[5].alpha_test = AlphaTest::less;
    scene.materials[6].alpha_mode = AlphaMode::blend, scene.materials[6].albedo_map.texture = 0;
    Random random(3);
    for (int part = 0; part < 2; ++part) {  // two meshes, so that triangles are counted over both
        Mesh mesh = soup(count / 2, 0.6f, 10 + std::uint64_t(part));
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            mesh.uvs.push_back({random.uniform(-1.f, 2.f), random.uniform(-1.f, 2.f)});
            mesh.uvs1.push_back({random.uniform(-1.f, 2.f), random.uniform(-1.f, 2.f)});
            if (part == 0) mesh.colors.emplace_back(glm::vec3(1.f), random.uniform(0.f, 1.f));
        }
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) mesh.materials.push_back(random.below(7));
        scene.meshes.push_back(mesh);
    }
    return scene;
}

double wrapped_texel(double i, unsigned size, Wrap wrap) {
    if (wrap == Wrap::clamp) return std::clamp(i, 0.0, size - 1.0);
    const double period = wrap == Wrap::mirror ? 2.0 * size : size, m = i - period * std::floor(i / period);
    return m < size ? m : period - 1 - m;
}

/// One channel of bytes that are linear.
double texel_of(const Texture& t, glm::dvec2 uv, unsigned channel) {
    const double x = uv.x * t.width - 0.5, y = uv.y * t.height - 0.5;
    double sum = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const double i = std::floor(x) + corner % 2, j = std::floor(y) + corner / 2;
        const double weight = (1 - std::abs(x - i)) * (1 - std::abs(y - j));
        const std::size_t at = std::size_t(wrapped_texel(j, t.height, t.wrap_v)) * t.width +
                               std::size_t(wrapped_texel(i, t.width, t.wrap_u));
        sum += weight * t.bytes[at * t.channels + channel] / 255.0;
    }
    return sum;
}

glm::dvec2 coordinates(const Mesh& mesh, const glm::uvec3& t, const TextureUse& use, double u, double v) {
    const auto& uvs = use.uv_set ? mesh.uvs1 : mesh.uvs;
    const glm::dvec2 at = (1 - u - v) * glm::dvec2(uvs[t.x]) + u * glm::dvec2(uvs[t.y]) + v * glm::dvec2(uvs[t.z]);
    const double c = std::cos(double(use.rotation)), s = std::sin(double(use.rotation));
    return {c * at.x * use.scale.x + s * at.y * use.scale.y + use.offset.x,
            -s * at.x * use.scale.x + c * at.y * use.scale.y + use.offset.y};
}

std::uint32_t bits(float value) {
    std::uint32_t word;
    std::memcpy(&word, &value, 4);
    return word;
}

/// Opacity minus its threshold: the surface exists where this is positive.
double margin(const Scene& scene, const Ray& ray, const Mesh& mesh, std::size_t i, std::uint32_t primitive, double u,
              double v, bool back) {
    const Material& m = scene.materials[mesh.materials[i]];
    if (m.cull_back && back) return -1;
    if (m.alpha_mode == AlphaMode::opaque) return 1;
    double opacity = double(m.opacity);
    if (!mesh.colors.empty()) {
        const glm::uvec3& t = mesh.triangles[i];
        opacity *=
            (1 - u - v) * double(mesh.colors[t.x].w) + u * double(mesh.colors[t.y].w) + v * double(mesh.colors[t.z].w);
    }
    if (m.albedo_map.used())
        opacity *=
            texel_of(scene.textures[m.albedo_map.texture], coordinates(mesh, mesh.triangles[i], m.albedo_map, u, v), 3);
    if (m.opacity_map.used())
        opacity *= texel_of(scene.textures[m.opacity_map.texture],
                            coordinates(mesh, mesh.triangles[i], m.opacity_map, u, v), 0);
    if (m.alpha_mode == AlphaMode::mask)
        return (opacity - double(m.alpha_cutoff)) * (m.alpha_test == AlphaTest::less ? -1 : 1);
    const std::uint32_t word =
        hash_words(hash_words(bits(ray.ox), bits(ray.oy)),
                   hash_words(hash_words(bits(ray.oz), bits(ray.dx)), hash_words(bits(ray.dy), bits(ray.dz))));
    return opacity - double(unit_float(hash_words(word, primitive)));
}

struct ExpectedShare {
    double t = 0;
    std::uint32_t primitive = CLARAY_MISS;
    bool doubtful = false;  // an opacity too near its threshold for float32
};

ExpectedShare brute_force_hit(const Scene& scene, const Ray& ray) {
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    ExpectedShare best;
    best.t = double(ray.tmax);
    std::uint32_t primitive = 0;
    for (const Mesh& mesh : scene.meshes)
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++primitive) {
            const glm::uvec3 t = mesh.triangles[i];
            const glm::dvec3 a(mesh.positions[t.x]), e1 = glm::dvec3(mesh.positions[t.y]) - a,
                                                     e2 = glm::dvec3(mesh.positions[t.z]) - a;
            const glm::dvec3 p = glm::cross(d, e2), s = o - a, q = glm::cross(s, e1);
            const double det = glm::dot(e1, p), u = glm::dot(s, p) / det, v = glm::dot(d, q) / det,
                         at = glm::dot(e2, q) / det;
            if (!(u >= 0 && v >= 0 && u + v <= 1 && at > 0 && at < best.t)) continue;
            const double m = margin(scene, ray, mesh, i, primitive, u, v, det < 0);
            best.doubtful = best.doubtful || std::abs(m) < 1e-5;
            if (m >= 0) best.t = at, best.primitive = primitive;
        }
    return best;
}

struct CutoutScene {
    explicit CutoutScene(const Scene& of, Layout layout)
        : textures(device(), of), bvh(Bvh::build(device(), of.meshes, {.layout = layout})) {
        state_of(bvh).set_cutouts(textures.store);
    }
    Textures textures;
    Bvh bvh;
};

class Cutouts : public testing::TestWithParam<Layout> {};

TEST_P(Cutouts, HitsEqualAFloat64BruteForce) {
    const Scene scene = mixed_soup(300);
    CutoutScene on_device(scene, GetParam());
    const std::vector<Ray> rays = random_rays(20'000, 3.f, 0.9f, 5);
    const std::vector<Hit> hits = closest_hit(on_device.bvh, rays);
    const std::vector<std::uint8_t> occluded = any_hit(on_device.bvh, rays);
    std::size_t doubtful = 0, hit = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const ExpectedShare expected = brute_force_hit(scene, rays[i]);
        if (expected.doubtful) {
            ++doubtful;
            continue;
        }
        ASSERT_EQ(hits[i].primitive, expected.primitive) << "ray " << i;
        ASSERT_EQ(occluded[i] != 0, expected.primitive != CLARAY_MISS) << "ray " << i;
        if (expected.primitive == CLARAY_MISS) continue;
        ++hit;
        ASSERT_NEAR(double(hits[i].t), expected.t, 1e-6 * expected.t);
    }
    EXPECT_GT(hit, rays.size() / 4);
    EXPECT_LT(doubtful, rays.size() / 200);
}

/// Bit for bit, in every way there is to trace.
TEST_P(Cutouts, HitsDependOnNoTree) {
    const Scene scene = mixed_soup(4'000);
    CutoutScene on_device(scene, GetParam());
    const std::vector<Ray> rays = random_rays(2'000, 3.f, 0.9f, 6);
    const auto same = [](const std::vector<Hit>& a, const std::vector<Hit>& b) {
        return std::memcmp(a.data(), b.data(), a.size() * sizeof(Hit)) == 0;
    };
    const std::vector<Hit> hits = closest_hit(on_device.bvh, rays, brute_force);
    EXPECT_TRUE(same(closest_hit(on_device.bvh, rays), hits));
    for (const Coherence coherence : {Coherence::coherent, Coherence::incoherent}) {
        QueryOptions options;
        options.coherence = coherence;
        EXPECT_TRUE(same(closest_hit(on_device.bvh, rays, options), hits));
    }
    EXPECT_EQ(any_hit(on_device.bvh, rays), any_hit(on_device.bvh, rays, brute_force));
    Bvh split =
        Bvh::build(device(), scene.meshes, {.builder = Builder::high, .layout = GetParam(), .max_leaf_triangles = 4});
    state_of(split).set_cutouts(on_device.textures.store);
    EXPECT_TRUE(same(closest_hit(split, rays), hits));
    state_of(split).set_cutouts({});
    EXPECT_FALSE(same(closest_hit(split, rays), hits));
}

/// Each mesh as an identity instance: the same hits as in one structure.
TEST_P(Cutouts, InstancesKnowTheirTriangles) {
    const Scene scene = mixed_soup(300);
    CutoutScene whole(scene, GetParam());
    const std::vector<Bvh> bottoms = build_bottoms(scene.meshes, GetParam());
    const auto first = std::uint32_t(scene.meshes[0].triangles.size());
    InstancedBvh instances =
        InstancedBvh::build(bottoms, std::vector<Instance>{make_instance(glm::mat4(1.f), 0, 0xffffffffu, 0),
                                                           make_instance(glm::mat4(1.f), 1, 0xffffffffu, first)});
    state_of(instances).set_cutouts(whole.textures.store);
    const std::vector<Ray> rays = random_rays(5'000, 3.f, 0.9f, 8);
    const std::vector<Hit> expected = closest_hit(whole.bvh, rays);
    const std::vector<InstanceHit> hits = closest_hit(instances, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].t, expected[i].t);
        if (expected[i].primitive == CLARAY_MISS) continue;
        ASSERT_EQ(hits[i].primitive + (hits[i].instance == 1 ? first : 0), expected[i].primitive);
    }
    EXPECT_EQ(any_hit(instances, rays), any_hit(whole.bvh, rays));
    state_of(instances).set_cutouts({});
    EXPECT_NE(any_hit(instances, rays), any_hit(whole.bvh, rays));
}

INSTANTIATE_TEST_SUITE_P(Layouts, Cutouts, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "Wide" : "Binary"; });

// ---- in images
// -------------------------------------------------------------------------------------------------------

/// Black before a white sky, so that the image shows coverage.
Scene leaf_card(const Texture& texture) {
    Scene scene;
    scene.textures = {texture};
    scene.materials = {lambert(0.f)};
    scene.materials[0].albedo_map.texture = 0;
    scene.meshes = {mapped_square()};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}, float(2 * std::atan(0.1) * 180 / std::numbers::pi)};
    return scene;
}

Texture disc_texture(unsigned size, double radius) {
    Texture t = random_texture({size, size}, 4, TexelFormat::srgb8, 1);
    for (unsigned y = 0; y < size; ++y)
        for (unsigned x = 0; x < size; ++x) {  // a ramp that crosses one half at the radius
            const double distance = std::hypot((x + 0.5) / size - 0.5, (y + 0.5) / size - 0.5);
            t.bytes[4 * (y * size + x) + 3] =
                std::uint8_t(std::lround(255 * std::clamp(0.5 + (radius - distance) * 8, 0.0, 1.0)));
        }
    return t;
}

const RenderConfig disc_config{.width = 64, .height = 64, .spp = 64};

TEST(AlphaMask, CoversTheAreaOfItsMask) {
    Scene scene = leaf_card(disc_texture(64, 0.35));
    scene.materials[0].alpha_mode = AlphaMode::mask;
    const double covered = 1 - mean(render_image(scene, disc_config)).x;
    EXPECT_NEAR(covered, std::numbers::pi * 0.35 * 0.35, 0.002);
    scene.materials[0].alpha_mode = AlphaMode::opaque;
    EXPECT_NEAR(mean(render_image(scene, disc_config)).x, 0, 1e-6);
}

/// What has just the opacity of the cut-off is there, as glTF has it.
TEST(AlphaMask, IsThereFromTheCutOffOn) {
    Scene scene = leaf_card(random_texture({2, 1}, 4, TexelFormat::linear8, 1));
    scene.textures[0].bytes = {0, 0, 0, 255, 0, 0, 0, 0};
    scene.textures[0].filter = Filter::nearest;
    scene.materials[0].alpha_mode = AlphaMode::mask;
    scene.materials[0].opacity = scene.materials[0].alpha_cutoff = 0.5f;
    EXPECT_NEAR(mean(render_image(scene, disc_config)).x, 0.5, 0.01);
    scene.materials[0].opacity = std::nextafter(0.5f, 0.f);
    EXPECT_EQ(mean(render_image(scene, disc_config)).x, 1);
}

/// A card whose left half has an opacity of the cut-off or a float beside it, and whose right half has none.
TEST(AlphaMask, IsComparedAsTheMaterialSays) {
    Scene scene = leaf_card(random_texture({2, 1}, 4, TexelFormat::linear8, 1));
    scene.textures[0].bytes = {0, 0, 0, 255, 0, 0, 0, 0};
    scene.textures[0].filter = Filter::nearest;
    scene.materials[0].alpha_mode = AlphaMode::mask, scene.materials[0].alpha_cutoff = 0.5f;
    struct Row {
        AlphaTest test;
        double below, at, above, nothing;  // 1: the half is there
    };
    for (const Row& row : {Row{AlphaTest::greater_equal, 0, 1, 1, 0}, Row{AlphaTest::greater, 0, 0, 1, 0},
                           Row{AlphaTest::less, 1, 0, 0, 1}, Row{AlphaTest::less_equal, 1, 1, 0, 1},
                           Row{AlphaTest::equal, 0, 1, 0, 0}, Row{AlphaTest::not_equal, 1, 0, 1, 1}}) {
        scene.materials[0].alpha_test = row.test;
        const auto covered = [&](float opacity) {
            scene.materials[0].opacity = opacity;
            return 1 - mean(render_image(scene, {.width = 8, .height = 8, .spp = 1})).x;
        };
        EXPECT_EQ(covered(std::nextafter(0.5f, 0.f)), 0.5 * (row.below + row.nothing)) << int(row.test);
        EXPECT_EQ(covered(0.5f), 0.5 * (row.at + row.nothing)) << int(row.test);
        EXPECT_EQ(covered(std::nextafter(0.5f, 1.f)), 0.5 * (row.above + row.nothing)) << int(row.test);
    }
}

/// Without a texture with holes, the opacity of the material alone decides.
TEST(AlphaMask, OfSolidMaterialsIsDecidedOnce) {
    Scene scene = leaf_card(random_texture({2, 1}, 3, TexelFormat::linear8, 1));
    scene.materials[0].alpha_mode = AlphaMode::mask, scene.materials[0].alpha_test = AlphaTest::less;
    EXPECT_EQ(mean(render_image(scene, {.width = 4, .height = 4, .spp = 1})).x, 1);
    EXPECT_TRUE(effects_of(scene).has(Effect::cut_outs));
    scene.materials[0].opacity = 0.25f;
    EXPECT_FALSE(effects_of(scene).has(Effect::cut_outs));
}

/// What a card lets through of the light is its shadow's brightness.
TEST(AlphaMask, CastsTheShadowOfItsMask) {
    Scene scene = leaf_card(disc_texture(64, 0.35));
    scene.materials[0].alpha_mode = AlphaMode::mask;
    scene.materials.push_back(lambert(1.f));
    for (glm::vec3& p : scene.meshes[0].positions) p *= 0.1f, p.y = 5.f;
    scene.meshes.push_back(square(1.f, 0.f, 1));
    scene.sky = {};
    scene.lights = {point_light({0, 100, 0}, glm::vec3(float(1e4 * std::numbers::pi)))};
    const auto seen = [&](double u, double v) {
        Scene at = scene;
        const glm::vec3 p(float(0.2 * u - 0.1) * 100 / 95, 0, float(0.2 * v - 0.1) * 100 / 95);
        at.camera = narrow_camera(p + glm::vec3(1, 1, 0), p);
        return mean(render_image(at, {.width = 1, .height = 1, .spp = 1, .max_depth = 1})).x;
    };
    EXPECT_NEAR(seen(0.5, 0.5), 0, 1e-6);
    EXPECT_NEAR(seen(0.5, 0.82), 0, 1e-6);
    EXPECT_NEAR(seen(0.5, 0.88), 1, 1e-3);
    EXPECT_NEAR(seen(0.05, 0.05), 1, 1e-3);
}

TEST(AlphaBlend, LayersLetThroughThePowerOfTheRest) {
    Scene scene;
    scene.materials = {lambert(0.f)};
    scene.materials[0].alpha_mode = AlphaMode::blend, scene.materials[0].opacity = 0.3f;
    for (int i = 0; i < 4; ++i) scene.meshes.push_back(square(1.f, 0.1f * float(i)));
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}, 5.f};
    const double through = mean(render_image(scene, {.width = 64, .height = 64, .spp = 64})).x;
    const double expected = std::pow(0.7, 4), sigma = std::sqrt(expected * (1 - expected) / (64 * 64 * 64));
    EXPECT_NEAR(through, expected, 3 * sigma);
    EXPECT_NEAR(through / expected, 1, 0.005);
}

TEST(BackFaces, AreNotThereWhereAllAreCulled) {
    Scene scene = leaf_card(disc_texture(8, 0.3));
    scene.textures.clear();
    scene.materials[0] = lambert(0.f);
    scene.materials[0].cull_back = true;
    EXPECT_EQ(mean(render_image(scene, disc_config)).x, 0);
    scene.camera->position.y = -10.f;
    EXPECT_EQ(mean(render_image(scene, disc_config)).x, 1);
    EXPECT_FALSE(Textures(device(), scene).store.allocated());  // queries cull back faces without a store
}

TEST(BackFaces, AreNotThereWhereSomeAreCulled) {
    Scene scene = leaf_card(disc_texture(8, 0.3));
    scene.materials = {lambert(0.f), lambert(0.f)};
    scene.materials[0].cull_back = true;
    scene.meshes.push_back(square(0.5f, -1.f, 1));
    scene.camera->position.y = -10.f;
    const double covered = 1 - mean(render_image(scene, disc_config)).x;
    EXPECT_NEAR(covered, 0.25 * std::pow(10 / 9.0, 2), 0.002);  // only the smaller square, at distance 9
    EXPECT_TRUE(Textures(device(), scene).has_cutouts);
}

// ---- memory
// ----------------------------------------------------------------------------------------------------------

TEST(CutoutMemory, SolidSurfacesHaveNone) {
    Scene scene = leaf_card(disc_texture(8, 0.3));
    EXPECT_FALSE(Textures(device(), scene).has_cutouts);  // opaque by its mode
    scene.materials[0].alpha_mode = AlphaMode::mask;
    EXPECT_TRUE(Textures(device(), scene).has_cutouts);
    for (std::size_t i = 3; i < scene.textures[0].bytes.size(); i += 4) scene.textures[0].bytes[i] = 255;
    EXPECT_FALSE(Textures(device(), scene).has_cutouts);  // nothing is cut out
    scene.materials[0].alpha_mode = AlphaMode::blend;
    EXPECT_FALSE(Textures(device(), scene).has_cutouts);
    scene.materials[0].opacity = 0.5f;
    EXPECT_TRUE(Textures(device(), scene).has_cutouts);
    scene.materials[0].opacity = 1.f;
    scene.meshes[0].colors.assign(4, glm::vec4(1.f));
    EXPECT_FALSE(Textures(device(), scene).has_cutouts);
    scene.meshes[0].colors[2].w = 0.5f;
    EXPECT_TRUE(Textures(device(), scene).has_cutouts);
}

}  // namespace
}  // namespace claray::test
