// Maps of materials as seen in images: colours, transforms, two sets of coordinates, footprints, normal and height
// maps.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "host/lights/lights.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

/// Under a white sky a plane's radiance is its albedo.
Scene plane_under_sky(const Texture& texture) {
    Scene scene;
    scene.textures = {texture};
    scene.materials = {textured(0)};
    scene.meshes = {mapped_square()};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    return scene;
}

/// What is seen at (u, v) of a mapped square.
glm::dvec3 seen_at(Scene scene, double u, double v, RenderConfig config = {.width = 2, .height = 2, .spp = 4}) {
    const glm::vec3 at(float(2 * u - 1), 0, float(2 * v - 1));
    scene.camera = narrow_camera(at + glm::vec3(0.1f, 1.f, 0.2f), at);
    return mean(render_image(scene, config));
}

double smooth(double u, double v) { return 0.5 + 0.2 * std::sin(2 * pi * u) + 0.2 * std::cos(2 * pi * v); }

// ---- colours
// ---------------------------------------------------------------------------------------------------------

TEST(AlbedoMap, PlaneUnderASkyShowsTheImage) {
    const Scene scene = plane_under_sky(float_texture({64, 64}, [](double u, double v) { return smooth(u, v); }));
    for (const auto& [u, v] : {std::pair(0.1, 0.2), std::pair(0.5, 0.9), std::pair(0.77, 0.33)})
        EXPECT_NEAR(seen_at(scene, u, v).x, smooth(u, v), 1e-3) << u << ' ' << v;
}

/// The image's mean is the light of a lamp reflected by the whole plane, by inverse square and cosine.
TEST(AlbedoMap, LambertPlaneUnderALampEqualsTheClosedForm) {
    Scene scene = plane_under_sky(float_texture({32, 32}, [](double u, double v) { return smooth(u, v); }));
    scene.materials[0].albedo = {1.f, 0.5f, 0.25f};
    scene.sky = {};
    scene.lights = {point_light({0.3f, 1.5f, -0.2f}, glm::vec3(4.f))};
    for (const auto& [u, v] : {std::pair(0.15, 0.25), std::pair(0.6, 0.8)}) {
        const glm::dvec3 to(0.3 - (2 * u - 1), 1.5, -0.2 - (2 * v - 1));
        const double d = glm::length(to), irradiance = 4 * 1.5 / (d * d * d);
        const glm::dvec3 radiance = seen_at(scene, u, v);
        EXPECT_NEAR(radiance.x / (smooth(u, v) / pi * irradiance), 1, 0.005);
        EXPECT_NEAR(radiance.y / radiance.x, 0.5, 1e-4);
        EXPECT_NEAR(radiance.z / radiance.x, 0.25, 1e-4);
    }
}

TEST(AlbedoMap, BytesFollowTheSrgbCurve) {
    Texture t = random_texture({1, 1}, 3, TexelFormat::srgb8, 1);
    t.bytes[0] = 188, t.bytes[1] = 55, t.bytes[2] = 255;
    const glm::dvec3 color = seen_at(plane_under_sky(t), 0.4, 0.6);
    const auto curve = [](double byte) { return std::pow((byte / 255 + 0.055) / 1.055, 2.4); };
    EXPECT_NEAR(color.x, curve(188), 1e-5);
    EXPECT_NEAR(color.y, curve(55), 1e-5);
    EXPECT_NEAR(color.z, 1, 1e-5);
}

TEST(AlbedoMap, AovsShowTheImage) {
    Scene scene = plane_under_sky(float_texture({64, 64}, [](double u, double v) { return smooth(u, v); }));
    scene.camera = narrow_camera({0.1f, 1.f, -0.4f}, {0.1f, 0.f, -0.4f});
    EXPECT_NEAR(double(Renderer(device(), scene, {.width = 1, .height = 1}).aovs().albedo[0].x), smooth(0.55, 0.3),
                1e-3);
}

TEST(EmissionMap, IsWhatTheSurfaceShines) {
    Scene scene = plane_under_sky(float_texture({64, 64}, [](double u, double v) { return smooth(u, v); }));
    scene.sky = {};
    scene.materials[0] = emitter(3.f);
    scene.materials[0].emission_map.texture = 0;
    EXPECT_NEAR(seen_at(scene, 0.3, 0.8).x, 3 * smooth(0.3, 0.8), 3e-3);
}

/// Light of a lamp with an image on it arrives in full: a lamp whose image is constant lights as one without.
TEST(EmissionMap, LightsTheSceneAsItsMean) {
    Scene scene;
    scene.textures = {float_texture({2, 2}, [](double, double) { return 0.5; })};
    scene.materials = {lambert(0.6f), emitter(3.f)};
    scene.meshes = {square(1.f, 0.f), square(1.f, 1.f, 1)};
    for (glm::uvec3& t : scene.meshes[1].triangles) std::swap(t.y, t.z);
    scene.meshes[1].uvs.assign(4, glm::vec2(0.5f));
    scene.camera = narrow_camera({3, 0.5f, 0}, {0.25f, 0, 0.5f});
    const RenderConfig config{.width = 8, .height = 8, .spp = 1024, .max_depth = 1};
    const double plain = mean(render_image(scene, config)).x;
    scene.materials[1].emission_map.texture = 0;
    EXPECT_NEAR(mean(render_image(scene, config)).x / plain, 0.5, 0.005);
}

/// Texels become separate triangles: the same light, with each triangle's average emission as a light.
TEST(EmissionMap, IsSampledAsLampsOfItsTexels) {
    Scene scene;
    Texture image = float_texture({4, 1}, [](double u, double) { return u < 0.5 ? 0.0 : u < 0.75 ? 1.0 : 3.0; });
    image.filter = Filter::nearest;
    scene.textures = {image};
    scene.materials = {lambert(0.6f), emitter(2.f)};
    scene.materials[1].emission_map.texture = 0;
    scene.meshes = {square(9.f, 0.f)};
    Scene plain = scene;
    plain.textures.clear(), plain.materials[1] = emitter(2.f), plain.materials.push_back(emitter(6.f));
    const auto strip = [](float x0, float x1, std::uint32_t material) {
        Mesh mesh;
        mesh.positions = {{x0, 1, -1}, {x1, 1, -1}, {x1, 1, 1}, {x0, 1, 1}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        mesh.materials = {material, material};
        mesh.uvs = {{0.25f * (x0 + 2), 0}, {0.25f * (x1 + 2), 0}, {0.25f * (x1 + 2), 1}, {0.25f * (x0 + 2), 1}};
        return mesh;
    };
    scene.meshes.push_back(strip(-2, 0, 1)), scene.meshes.push_back(strip(0, 2, 1));
    plain.meshes.push_back(strip(0, 1, 1)), plain.meshes.push_back(strip(1, 2, 2));

    const Lights lights = collect_lights(scene);
    ASSERT_EQ(lights.triangles.size(), 2u);  // the black half is none
    double sum = 0;
    for (const TriangleLight& t : lights.triangles) sum += double(t.emission_r) * t.area;
    EXPECT_NEAR(sum / (2 * 2 + 6 * 2), 1, 0.02);

    scene.camera = plain.camera = narrow_camera({0, 0.5f, 3}, {0.3f, 0, 0.2f});
    const RenderConfig config{.width = 16, .height = 16, .spp = 256, .max_depth = 1};
    Renderer mapped(device(), scene, config), split(device(), plain, config);
    const double error_of_mapped = mapped.render().noise / 16, error_of_split = split.render().noise / 16;
    const double error = std::hypot(error_of_mapped, error_of_split);
    EXPECT_LT(error, 0.0015);
    EXPECT_NEAR(mean(mapped.image()).x / mean(split.image()).x, 1, std::min(3 * error + 1e-4, 0.005));
}

TEST(RoughnessMap, MultipliesTheRoughness) {
    Scene scene = plane_under_sky(float_texture({1, 1}, [](double, double) { return 0.5; }));
    scene.materials[0] = material(MaterialKind::metal, 0.9f, 0.8f);
    scene.sky = {glm::vec3(0.f), glm::vec3(1.f)};
    Scene plain = scene;
    plain.materials[0].roughness = 0.4f;
    scene.materials[0].metallic_roughness_map.texture = 0;
    const RenderConfig config{.width = 4, .height = 4, .spp = 64};
    EXPECT_EQ(seen_at(scene, 0.5, 0.5, config), seen_at(plain, 0.5, 0.5, config));
}

/// Each reads its own channel, as glTF has it: a map of one value is a factor.
TEST(MaterialMaps, OfOneValueAreFactors) {
    Material base = material(MaterialKind::principled, 0.8f, 0.6f);
    base.metallic = 0.5f, base.transmission = 0.75f, base.clearcoat = 0.5f, base.clearcoat_roughness = 0.4f;
    struct Case {
        const char* name;
        TextureUse Material::*map;
        void (*multiply)(Material&);
    };
    const Case cases[] = {
        {"metallic and roughness", &Material::metallic_roughness_map,
         [](Material& m) { m.roughness *= 0.5f, m.metallic *= 0.75f; }},
        {"transmission", &Material::transmission_map, [](Material& m) { m.transmission *= 0.25f; }},
        {"clearcoat", &Material::clearcoat_map, [](Material& m) { m.clearcoat *= 0.25f; }},
        {"clearcoat roughness", &Material::clearcoat_roughness_map, [](Material& m) { m.clearcoat_roughness *= 0.5f; }},
    };
    const RenderConfig config{.width = 8, .height = 8, .spp = 64};
    for (const Case& one : cases) {
        Scene scene =
            plane_under_sky(float_texture({1, 1}, [](double, double) { return glm::vec3(0.25f, 0.5f, 0.75f); }));
        scene.sky = {glm::vec3(0.1f), glm::vec3(1.f)};
        scene.materials[0] = base;
        Scene multiplied = scene;
        one.multiply(multiplied.materials[0]);
        scene.materials[0].*one.map = {.texture = 0};
        EXPECT_EQ(seen_at(scene, 0.5, 0.5, config), seen_at(multiplied, 0.5, 0.5, config)) << one.name;
    }
}

// ---- coordinates
// -----------------------------------------------------------------------------------------------------

/// KHR_texture_transform's own example: the lower left quadrant of the image, turned clockwise by 90 degrees.
TEST(TextureTransform, LowerLeftQuadrantTurnedClockwise) {
    Scene scene = plane_under_sky(float_texture({64, 64}, [](double u, double v) { return glm::vec3(u, v, 0.f); }));
    TextureUse& use = scene.materials[0].albedo_map;
    use.offset = {0.f, 1.f}, use.rotation = float(pi / 2), use.scale = {0.5f, 0.5f};
    // Turned clockwise, the quadrant's lower left corner (0, 1) comes to the upper left, its upper left to the upper
    // right.
    EXPECT_NEAR(seen_at(scene, 0.02, 0.02).y, 0.99, 0.003);
    EXPECT_NEAR(seen_at(scene, 0.02, 0.02).x, 0.01, 0.003);
    EXPECT_NEAR(seen_at(scene, 0.98, 0.02).y, 0.51, 0.003);
    EXPECT_NEAR(seen_at(scene, 0.98, 0.02).x, 0.01, 0.003);
    EXPECT_NEAR(seen_at(scene, 0.02, 0.98).x, 0.49, 0.003);
}

TEST(TextureTransform, ScalesThenTurnsThenShifts) {
    Scene scene = plane_under_sky(float_texture({256, 256}, [](double u, double v) { return glm::vec3(u, v, 0.f); }));
    TextureUse& use = scene.materials[0].albedo_map;
    use.offset = {0.3f, 0.2f}, use.rotation = 0.4f, use.scale = {0.4f, 0.3f};
    const double c = std::cos(0.4), s = std::sin(0.4);
    for (const auto& [u, v] : {std::pair(0.1, 0.9), std::pair(0.6, 0.7)}) {
        const double x = 0.4 * u, y = 0.3 * v;
        const glm::dvec3 color = seen_at(scene, u, v);
        EXPECT_NEAR(color.x, c * x + s * y + 0.3, 1e-3);
        EXPECT_NEAR(color.y, -s * x + c * y + 0.2, 1e-3);
    }
}

TEST(TextureCoordinateSets, EachMapHasItsOwn) {
    Scene scene = plane_under_sky(float_texture({64, 64}, [](double u, double v) { return smooth(u, v); }));
    scene.meshes[0].uvs1 = scene.meshes[0].uvs;
    for (glm::vec2& uv : scene.meshes[0].uvs1) uv = 0.5f * uv;
    for (glm::vec2& uv : scene.meshes[0].uvs) uv = glm::vec2(0.25f);
    EXPECT_NEAR(seen_at(scene, 0.6, 0.4).x, smooth(0.25, 0.25), 1e-3);
    scene.materials[0].albedo_map.uv_set = 1;
    EXPECT_NEAR(seen_at(scene, 0.6, 0.4).x, smooth(0.3, 0.2), 1e-3);
}

// ---- footprints

/// A checkerboard to the horizon: where squares are far smaller than a pixel, one sample per pixel gives grey.
TEST(Footprint, CheckerboardFadesToGrey) {
    Texture checker = random_texture({2, 2}, 1, TexelFormat::linear8, 1);
    for (unsigned i = 0; i < 4; ++i) checker.bytes[i] = i == 1 || i == 2 ? 255 : 0;
    const auto far_rows = [&](Filter filter) {
        checker.filter = filter;
        Scene scene = plane_under_sky(checker);
        for (glm::vec3& p : scene.meshes[0].positions) p *= 1000.f;
        for (glm::vec2& uv : scene.meshes[0].uvs) uv *= 1000.f;
        scene.camera = Camera{{0, 2, 0}, {0, 0, -100}, {0, 1, 0}, 30.f};
        const auto image = render_image(scene, {.width = 64, .height = 64, .spp = 1, .max_depth = 1});
        double sum = 0, squares = 0;
        for (std::size_t i = 64 * 33; i < 64 * 36; ++i)
            sum += double(image[i].x), squares += std::pow(double(image[i].x), 2);
        const double mean = sum / 192;
        return std::pair(mean, squares / 192 - mean * mean);
    };
    const auto [mean, variance] = far_rows(Filter::trilinear);
    EXPECT_NEAR(mean, 0.5, 0.01);
    EXPECT_LT(variance, 1e-4);
    EXPECT_GT(far_rows(Filter::nearest).second, 0.1);  // the error without filtering
}

Scene striped_square() {
    Scene scene;
    scene.textures = {float_texture({64, 64}, [](double u, double) { return int(u * 32) % 2; })};
    scene.textures[0].filter = Filter::trilinear;
    scene.materials = {emitter(1.f)};
    scene.materials[0].emission_map.texture = 0;
    scene.meshes = {mapped_square()};
    return scene;
}

/// Two texels a pixel, in stripes of two: where every stripe is one texel of level 1, its pixel sees 3/4 of it between
/// its neighbours by bilinear filtering. Level 0 would show 7/8, level 2 grey.
TEST(Footprint, PicksTheLevelWhoseTexelsArePixels) {
    Scene scene = striped_square();
    scene.camera = Camera{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}, float(2 * std::atan(0.1) * 180 / pi)};
    const auto image = render_image(scene, {.width = 32, .height = 32, .spp = 64, .max_depth = 1});
    for (unsigned i = 32 * 15; i < 32 * 17; ++i) ASSERT_NEAR(image[i].x, i % 2 ? 0.75f : 0.25f, 0.03f) << i;
}

/// The same stripes at any distance: parallel rays have the footprint of a pixel everywhere.
TEST(Footprint, OfParallelRaysIsThatOfAPixel) {
    Scene scene = striped_square();
    for (const float distance : {0.5f, 40.f}) {
        scene.camera = Camera{{0, distance, 0}, {0, 0, 0}, {0, 0, -1}};
        scene.camera->projection = Projection::orthographic, scene.camera->orthographic_height = 2.f;
        const auto image = render_image(scene, {.width = 32, .height = 32, .spp = 64, .max_depth = 1});
        for (unsigned i = 32 * 15; i < 32 * 17; ++i)
            ASSERT_NEAR(image[i].x, i % 2 ? 0.75f : 0.25f, 0.03f) << i << " from " << distance;
    }
}

/// Nearby the finest level is used: mip maps change nothing if a texel is larger than a pixel.
TEST(Footprint, NearbyTexelsStaySharp) {
    Texture t = random_texture({8, 8}, 3, TexelFormat::float32, 9);
    t.filter = Filter::bilinear;
    const glm::dvec3 sharp = seen_at(plane_under_sky(t), 0.47, 0.31);
    t.filter = Filter::trilinear;
    EXPECT_EQ(seen_at(plane_under_sky(t), 0.47, 0.31), sharp);
}

/// A mirror keeps the camera's cone, so that its image is filtered as at the sum of both distances.
TEST(Footprint, GoesOnBeyondAMirror) {
    Scene scene;
    scene.textures = {float_texture({256, 256}, [](double u, double v) { return (int(u * 256) + int(v * 256)) % 2; })};
    scene.textures[0].filter = Filter::trilinear;
    scene.materials = {emitter(1.f), material(MaterialKind::mirror, 1.f)};
    scene.materials[0].emission_map.texture = 0;
    scene.meshes = {mapped_square(), square(1.f, 8.f, 1)};
    // A pixel is 2.4 texels wide at distance 12, where the image is; from the mirror it would be 1.6.
    scene.camera = Camera{{0, 4, 0}, {0, 8, 0}, {0, 0, 1}, 5.73f};
    const auto image = render_image(scene, {.width = 64, .height = 64, .spp = 1, .max_depth = 2});
    for (const glm::vec3& c : image) ASSERT_NEAR(c.x, 0.5f, 0.02f);
}

/// After a Lambertian, whose ray could have gone anywhere, a fine pattern is seen as its mean, and not as this or that
/// texel.
TEST(Footprint, IsWideAfterScattering) {
    Scene scene;
    scene.textures = {float_texture({256, 256}, [](double u, double v) { return (int(u * 256) + int(v * 256)) % 2; })};
    scene.materials = {emitter(1.f), lambert(1.f)};
    scene.materials[0].emission_map.texture = 0;
    scene.meshes = {mapped_square(), square(0.01f, -0.5f, 1)};
    for (glm::vec3& p : scene.meshes[0].positions) p *= 400.f;  // so that no ray misses it
    for (glm::vec2& uv : scene.meshes[0].uvs) uv *= 1600.f;     // texels are a quarter as wide as the cones
    scene.camera = narrow_camera({0.01f, -0.1f, 0}, {0, -0.5f, 0});
    RenderConfig config{.width = 16, .height = 16, .spp = 1, .max_depth = 1};
    config.effects.add = {Effect::mip_maps};  // one kernel for both
    const auto spread = [&](Filter filter) {
        scene.textures[0].filter = filter;
        double sum = 0, squares = 0;
        for (const glm::vec3& c :
             render_by_techniques(2, scene, config))  // a light's sample would be a point, without a cone
            sum += c.x, squares += double(c.x) * c.x;
        return squares / 256 - std::pow(sum / 256, 2);
    };
    const double of_texels = spread(Filter::nearest), of_footprints = spread(Filter::trilinear);
    EXPECT_GT(of_texels, 0.2);
    EXPECT_LT(of_footprints, 1e-4);
}

/// Light that a bright disc in a texture reflects to a point over its middle, against a float64 sum over the
/// hemisphere: a cone that took in more than a small part of the disc would make it dimmer.
TEST(Footprint, AfterScatteringTakesNoLightAway) {
    const auto disc = [](double u, double v) { return 0.1 + 0.8 * std::exp(-60 * (u * u + v * v)); };
    Scene scene;
    scene.textures = {float_texture({256, 256}, [&](double u, double v) { return disc(u - 0.5, v - 0.5); })};
    scene.textures[0].filter = Filter::trilinear;
    scene.materials = {textured(0), lambert(1.f)};
    scene.meshes = {mapped_square(), square(0.001f, 1.f, 1)};
    for (glm::vec3& p : scene.meshes[0].positions) p *= 4.f;
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {1.f, -2.f, 0.f}, sun.intensity = glm::vec3(float(pi));
    scene.lights = {sun};
    scene.camera = narrow_camera({0.3f, 0.6f, 0}, {0, 1, 0});
    const int n = 400;
    double sum = 0;  // over directions down from the point, by their cosine
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
            const double z2 = (a + 0.5) / n, r = std::sqrt(1 / z2 - 1), phi = 2 * pi * (b + 0.5) / n;
            const double x = r * std::cos(phi), z = r * std::sin(phi);
            if (std::max(std::abs(x), std::abs(z)) < 4) sum += disc(x / 8, z / 8) * 2 / std::sqrt(5.0);
        }
    const RenderConfig config{.width = 16, .height = 16, .spp = 512, .max_depth = 2};
    EXPECT_NEAR(mean(render_image(scene, config)).x / (sum / n / n), 1, 1e-3);
}

// ---- normals

glm::dvec3 normal_at(Scene scene, double u, double v) {
    const glm::vec3 at(float(2 * u - 1), 0, float(2 * v - 1));
    scene.camera = narrow_camera(at + glm::vec3(0.f, 1.f, 0.f), at);
    return glm::dvec3(Renderer(device(), scene, {.width = 1, .height = 1}).aovs().normal[0]);
}

Scene with_normal_map(const glm::vec3& encoded) {
    Scene scene = plane_under_sky(float_texture({1, 1}, [&](double, double) { return encoded; }));
    scene.materials[0] = lambert(0.8f);
    scene.materials[0].normal_map.texture = 0;
    return scene;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(NormalMap, FlatChangesNothing) {
    Scene mapped = with_normal_map({0.5f, 0.5f, 1.f});
    mapped.lights = {point_light({0, 1, 0}, glm::vec3(1.f))};
    Scene plain = mapped;
    plain.materials[0].normal_map = {};
    const RenderConfig config{.width = 16, .height = 16, .spp = 4};
    const auto a = render_image(mapped, config), b = render_image(plain, config);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i].x, b[i].x, 2e-6f * b[i].x);
}

/// x is towards increasing u (+x of the square), y towards the image's top (-z).
TEST(NormalMap, TurnsTowardsTheImagesAxes) {
    expect_near(normal_at(with_normal_map({0.8f, 0.5f, 0.9f}), 0.4, 0.4), {0.6, 0.8, 0}, 1e-6);
    expect_near(normal_at(with_normal_map({0.5f, 0.8f, 0.9f}), 0.4, 0.4), {0, 0.8, -0.6}, 1e-6);
    Scene scaled = with_normal_map({0.8f, 0.5f, 0.9f});
    scaled.materials[0].normal_scale = 0.5f;
    expect_near(normal_at(scaled, 0.4, 0.4), glm::normalize(glm::dvec3(0.3, 0.8, 0)), 1e-6);
}

/// A mirrored image gives mirrored normals.
TEST(NormalMap, FollowsMirroredCoordinates) {
    Scene scene = with_normal_map({0.8f, 0.5f, 0.9f});
    for (glm::vec2& uv : scene.meshes[0].uvs) uv.x = 1.f - uv.x;
    expect_near(normal_at(scene, 0.4, 0.4), {-0.6, 0.8, 0}, 1e-6);
    scene = with_normal_map({0.5f, 0.8f, 0.9f});
    for (glm::vec2& uv : scene.meshes[0].uvs) uv.x = 1.f - uv.x;
    expect_near(normal_at(scene, 0.4, 0.4), {0, 0.8, -0.6}, 1e-6);
    scene.materials[0].normal_map.scale = {1.f, -1.f};
    expect_near(normal_at(scene, 0.4, 0.4), {0, 0.8, 0.6}, 1e-6);
}

TEST(NormalMap, GivenTangentsWin) {
    Scene scene = with_normal_map({0.8f, 0.5f, 0.9f});
    scene.meshes[0].tangents.assign(4, {0, 0, 1, 1});
    expect_near(normal_at(scene, 0.4, 0.4), {0, 0.8, 0.6}, 1e-6);
    scene = with_normal_map({0.5f, 0.8f, 0.9f});
    scene.meshes[0].tangents.assign(4, {0, 0, 1, 1});  // the bitangent is y cross z = x
    expect_near(normal_at(scene, 0.4, 0.4), {0.6, 0.8, 0}, 1e-6);
    scene.meshes[0].tangents.assign(4, {0, 0, 1, -1});
    expect_near(normal_at(scene, 0.4, 0.4), {-0.6, 0.8, 0}, 1e-6);
}

TEST(NormalMap, SeenFromBehindIsTheSameSurface) {
    Scene scene = with_normal_map({0.8f, 0.5f, 0.9f});
    scene.camera = narrow_camera({0.2f, -1.f, 0.1f}, {0.2f, 0.f, 0.1f});
    const glm::vec3 normal = Renderer(device(), scene, {.width = 1, .height = 1}).aovs().normal[0];
    expect_near(glm::dvec3(normal), {-0.6, -0.8, 0}, 1e-6);
}

/// The image's top does not move when the object is mirrored.
TEST(NormalMap, GivenTangentsOfMirroredInstances) {
    Scene scene = with_normal_map({0.5f, 0.8f, 0.9f});
    scene.meshes[0].tangents.assign(4, {1.f, 0.f, 0.f, 1.f});
    const glm::dvec3 plain = normal_at(scene, 0.5, 0.5);
    EXPECT_LT(plain.z, -0.1);
    glm::mat4 mirrored(1.f), away(1.f);
    mirrored[0][0] = -1.f, away[3] = {0.f, 0.f, 50.f, 1.f};
    scene.instances = {{0, mirrored}, {0, away}};  // two instances, so that neither is baked
    expect_near(normal_at(scene, 0.5, 0.5), plain, 1e-5);
}

/// Seen at a grazing angle by a mirror whose map tilts it away from the viewer: nothing is reflected into the surface.
TEST(NormalMap, NeverReflectsDownwards) {
    Scene scene = with_normal_map({0.9f, 0.5f, 0.8f});
    scene.materials = {material(MaterialKind::mirror, 1.f), lambert(0.f)};
    scene.materials[0].normal_map.texture = 0;
    scene.meshes.push_back(square(10.f, -0.01f, 1));
    scene.camera = narrow_camera({-1.f, 0.3f, 0.f}, {0, 0, 0});
    EXPECT_NEAR(mean(render_image(scene, {.width = 2, .height = 2, .spp = 4})).x, 1, 1e-5);
}

/// A texel below the surface turns the normal as its mirror image above does.
TEST(NormalMap, ThroughTheTriangleIsMirroredAtIt) {
    const glm::dvec3 above = normal_at(with_normal_map({0.8f, 0.5f, 0.7f}), 0.4, 0.4),
                     below = normal_at(with_normal_map({0.8f, 0.5f, 0.3f}), 0.4, 0.4);
    expect_near(below, above, 1e-5);
}

TEST(NormalMap, WithoutCoordinatesChangesNothing) {
    Scene scene = with_normal_map({0.8f, 0.5f, 0.9f});
    scene.meshes[0].uvs.clear();
    expect_near(normal_at(scene, 0.4, 0.4), {0, 1, 0}, 1e-6);
}

/// A ramp of slope 1 in a triangle with skewed edges and coordinates: exact.
TEST(HeightMap, RampIsExactUnderTransforms) {
    Scene scene = plane_under_sky(float_texture({64, 64}, [](double u, double) { return u; }));
    scene.materials[0] = lambert(0.8f);
    TextureUse& use = scene.materials[0].height_map;
    use.texture = 0, use.rotation = 0.5f, use.scale = {0.3f, 0.3f}, use.offset = {0.3f, 0.5f};
    scene.materials[0].height_scale = 2.f;
    // u' = 0.3 (cos u + sin v) + 0.3, and u, v change by 1/2 a unit along x and z
    const double gx = 2 * 0.3 * std::cos(0.5) / 2, gz = 2 * 0.3 * std::sin(0.5) / 2;
    expect_near(normal_at(scene, 0.3, 0.6), glm::normalize(glm::dvec3(-gx, 1, -gz)), 1e-4);
}

}  // namespace
}  // namespace claray::test
