// Lit sprites: Approximations::tile_sum of an orthographic view against the formula of 2D engines, in float64: Lambert
// with a normal of 2c - 1, and saturate(1 - d / radius).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "claray/shared/rng.h"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

constexpr unsigned image_width = 96, image_height = 54, sprite_texels = 8;
const RenderConfig sprite_frame = {
    .width = image_width, .height = image_height, .spp = 1, .max_depth = 1, .approximate = {.tile_sum = true}};

/// A square of side 1 in z = 0 that faces +z, with the image upright.
Mesh sprite() {
    Mesh mesh;
    mesh.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// Sprites of colours, normals and holes by chance, turned and scaled, each in a plane of its own.
Scene sprites(unsigned count, unsigned lights) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    Scene scene;
    scene.textures = {random_texture({sprite_texels, sprite_texels}, 4, TexelFormat::srgb8, 1),
                      random_texture({sprite_texels, sprite_texels}, 3, TexelFormat::linear8, 2)};
    for (unsigned i = 0; i < sprite_texels * sprite_texels; ++i)
        scene.textures[1].bytes[3 * i + 2] |= 0x80;  // no normal points away
    for (Texture& texture : scene.textures) texture.filter = Filter::nearest;
    scene.materials = {lambert(1.f)};
    scene.materials[0].albedo_map.texture = 0, scene.materials[0].normal_map.texture = 1;
    scene.materials[0].alpha_mode = AlphaMode::mask;
    scene.meshes = {sprite()};
    for (unsigned i = 0; i < count; ++i) {
        const float angle = float(pi) * unit(random), size = 1.5f + 0.5f * unit(random);
        glm::mat4 transform(1.f);
        transform[0] = size * glm::vec4(std::cos(angle), std::sin(angle), 0, 0);
        transform[1] = size * glm::vec4(-std::sin(angle), std::cos(angle), 0, 0);
        transform[3] = {3.5f * unit(random), 2 * unit(random), 0.01f * float(i), 1};
        scene.instances.push_back({0, transform});
    }
    for (unsigned i = 0; i < lights; ++i) {
        scene.lights.push_back(point_light({3.5f * unit(random), 2 * unit(random), 0.8f + 0.2f * unit(random)},
                                           float(pi) * (1.1f + glm::vec3(unit(random), unit(random), unit(random)))));
        scene.lights.back().range = 1.5f, scene.lights.back().linear_range = true;
        scene.lights.back().attenuation = {1, 0, 0};
    }
    scene.camera = Camera{.position = {0, 0, 5}, .projection = Projection::orthographic, .orthographic_height = 4.f};
    return scene;
}

/// The point of the image at which the renderer's first sample of this pixel lies.
glm::dvec2 sampled_point(unsigned pixel) {
    const SamplePair within = sample_pair(CLARAY_SOBOL, hash_words(pixel, 0), 0, 0);
    const double x = (pixel % image_width + double(unit_float(within.x))) / image_width,
                 y = (pixel / image_width + double(unit_float(within.y))) / image_height;
    return {(2 * x - 1) * 2 * image_width / image_height, 2 * (1 - 2 * y)};
}

struct SpriteTexel {
    glm::dvec3 place, albedo, normal;
};

/// What is on top there; `near_edge` is set where rounding may choose another texel.
std::optional<SpriteTexel> sprite_texel_at(const Scene& scene, const glm::dvec2& point, bool& near_edge) {
    for (std::size_t i = scene.instances.size(); i-- > 0;) {
        const glm::dmat4 transform(scene.instances[i].transform);
        const glm::dvec2 p = glm::inverse(glm::dmat2(transform)) * (point - glm::dvec2(transform[3]));
        const glm::dvec2 uv = double(sprite_texels) * glm::dvec2(p.x + 0.5, 0.5 - p.y);
        for (const double x : {uv.x, uv.y}) near_edge |= std::abs(x - std::round(x)) < 1e-4;
        if (std::min(uv.x, uv.y) < 0 || std::max(uv.x, uv.y) >= sprite_texels) continue;
        const std::size_t texel = std::size_t(uv.y) * sprite_texels + std::size_t(uv.x);
        const std::uint8_t* color = &scene.textures[0].bytes[4 * texel];
        const std::uint8_t* c = &scene.textures[1].bytes[3 * texel];
        if (color[3] < 128) continue;
        SpriteTexel found{glm::dvec3(point, transform[3].z), {}, {}};
        for (int k = 0; k < 3; ++k) {
            const double value = color[k] / 255.0;
            found.albedo[k] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
        }
        const glm::dvec3 n = 2.0 * glm::dvec3(c[0], c[1], c[2]) / 255.0 - 1.0;
        const glm::dvec3 right = glm::normalize(glm::dvec3(transform[0])),
                         up = glm::normalize(glm::dvec3(transform[1]));
        found.normal = glm::normalize(n.x * right + n.y * up + n.z * glm::dvec3(0, 0, 1));
        return found;
    }
    return {};
}

glm::dvec3 lit_sprite(const SpriteTexel& at, const std::vector<Light>& lights) {
    glm::dvec3 sum(0);
    for (const Light& light : lights) {
        const glm::dvec3 towards = glm::dvec3(light.position) - at.place;
        const double d = glm::length(towards), attenuation = std::clamp(1 - d / double(light.range), 0.0, 1.0);
        sum += glm::dvec3(light.intensity) / pi * attenuation * std::max(glm::dot(at.normal, towards) / d, 0.0);
    }
    return at.albedo * sum;
}

TEST(Lighting2d, IsTheFormulaOfTheSource) {
    const Scene scene = sprites(40, 60);
    const std::vector<glm::vec3> image = render_by_own_kernels(scene, sprite_frame);
    double largest = 0, worst = 0;
    unsigned compared = 0, seen = 0;
    for (unsigned pixel = 0; pixel < image_width * image_height; ++pixel) {
        bool near_edge = false;
        const std::optional<SpriteTexel> texel = sprite_texel_at(scene, sampled_point(pixel), near_edge);
        if (near_edge) continue;
        const glm::dvec3 expected = texel ? lit_sprite(*texel, scene.lights) : glm::dvec3(0);
        for (int k = 0; k < 3; ++k) {
            worst = std::max(worst, std::abs(double(image[pixel][k]) - expected[k]));
            largest = std::max(largest, expected[k]);
        }
        ++compared, seen += texel.has_value();
    }
    EXPECT_GT(compared, 0.9 * image_width * image_height);
    EXPECT_GT(seen, 0.3 * image_width * image_height);
    EXPECT_LT(worst, 1e-6 * largest) << "of " << largest;
}

/// deferred/flat_sixteen.clh: squares of one mesh under maps of all kinds of texels, some seen from behind, against the
/// path tracer's light of one lamp.
TEST(Lighting2d, IsThePathTracersLightOnFlatTriangles) {
    Scene scene;
    scene.meshes.resize(1);
    Mesh& mesh = scene.meshes[0];
    constexpr Wrap wraps[] = {Wrap::repeat, Wrap::mirror, Wrap::clamp};
    for (unsigned i = 0; i < 12; ++i) {
        const unsigned channels = i % 4 + 1;
        scene.textures.push_back(
            random_texture({7, 5}, channels, i % 3 == 2 ? TexelFormat::float32 : TexelFormat::srgb8, i));
        scene.textures.push_back(
            random_texture({6, 9}, 3, i % 5 == 4 ? TexelFormat::float32 : TexelFormat::linear8, 20 + i));
        for (Texture* texture : {&scene.textures[2 * i], &scene.textures[2 * i + 1]}) {
            texture->filter = i % 2 ? Filter::nearest : Filter::bilinear;
            texture->wrap_u = wraps[i % 3], texture->wrap_v = wraps[i / 3 % 3];
        }
        scene.materials.push_back(lambert(0.8f));
        if (i != 3) scene.materials[i].albedo_map.texture = 2 * i;
        if (i != 4)
            scene.materials[i].normal_map.texture = 2 * i + 1, scene.materials[i].normal_map.scale = {1.5f, -2.f};
        const auto first = std::uint32_t(mesh.positions.size());
        const glm::vec3 middle(1.5f * float(i % 4) - 2.25f, 1.2f * float(i / 4) - 1.2f, 0.1f * float(i % 3));
        for (const glm::vec3& corner : sprite().positions) {
            mesh.positions.push_back(middle +
                                     1.3f * glm::vec3(i % 5 == 1 ? -corner.x : corner.x, corner.y, 0.3f * corner.x));
            mesh.uvs.emplace_back(2.2f * corner.x - 0.3f, 1.7f * corner.y + 0.2f);
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2),
            mesh.triangles.emplace_back(first, first + 2, first + 3);
        mesh.materials.insert(mesh.materials.end(), 2, i);
    }
    scene.lights = {point_light({0.3f, 0.2f, 2.f}, glm::vec3(5.f, 4.f, 3.f))};
    scene.camera = Camera{.position = {0, 0, 5}, .projection = Projection::orthographic, .orthographic_height = 4.f};
    RenderConfig traced = sprite_frame;
    traced.approximate = {.no_shadows = true};
    const std::vector<glm::vec3> image = render_by_own_kernels(scene, sprite_frame),
                                 expected = render_by_own_kernels(scene, traced);
    float largest = 0, worst = 0;
    unsigned lit = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        largest = std::max(largest, expected[i].x), worst = std::max(worst, glm::length(image[i] - expected[i]));
        lit += expected[i].x > 0;
    }
    EXPECT_GT(lit, image.size() / 2);
    EXPECT_LT(worst, 1e-5f * largest);
}

TEST(Lighting2d, IsTheSumOverAllLightsBitForBit) {
    const Scene scene = sprites(60, 300);
    const std::vector<glm::vec3> listed = render_by_own_kernels(scene, sprite_frame);
    const ScopedTuning tiles("deferred/list_lights", "MOST_PER_TILE", 0),
        blocks("deferred/list_lights", "MOST_PER_BLOCK", 0);
    EXPECT_TRUE(same_bits(listed, render_by_own_kernels(scene, sprite_frame)));
}

/// The path tracer with depth 1 gives the same light where no sprite is above, and shadows where one is.
TEST(Lighting2d, HasShadowsByThePathTracer) {
    Scene scene = sprites(0, 0);
    scene.materials.push_back(lambert(1.f));
    Mesh ground = sprite();
    for (glm::vec3& p : ground.positions) p *= 20.f;
    ground.materials.assign(2, 1);
    scene.meshes.push_back(ground);
    glm::mat4 above(1.f);
    above[3] = {0, 0, 0.3f, 1};
    scene.materials[0].albedo_map = {}, scene.materials[0].normal_map = {};
    scene.instances = {{1}, {0, above}};
    scene.lights = {point_light({-1.5f, 0, 1}, glm::vec3(float(pi)))};
    scene.lights[0].range = 5, scene.lights[0].linear_range = true, scene.lights[0].attenuation = {1, 0, 0};
    const auto seen = [&](float x, bool shadows) {
        scene.camera = Camera{.position = {x, 0, 5},
                              .target = {x, 0, 0},
                              .projection = Projection::orthographic,
                              .orthographic_height = 1e-3f};
        RenderConfig config = {.width = 2, .height = 2, .spp = 1, .max_depth = 1};
        config.approximate.tile_sum = !shadows;
        return mean(render_by_own_kernels(scene, config)).x;
    };
    for (const float x : {-0.75f, 0.f, 0.55f, 1.5f}) {  // the shadow is from x = 0.5 to 0.714 and on
        const double open = seen(x, false);
        EXPECT_GT(open, 0.05);
        EXPECT_NEAR(seen(x, true), x == 0.55f ? 0 : open, 1e-5) << x;
    }
}

}  // namespace
}  // namespace claray::test
