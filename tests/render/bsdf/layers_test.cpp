// The layers of a principled material, against closed forms and float64 integrals independent of the kernels.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "host/verify/cases/rendering/bsdf.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;
using verify::at_angle;
using verify::TestedMaterial;

// ---- one direction ------------------------------------------------------------------------------------------------

/// A principled material without a base: only an interface.
Material interface_alone(float roughness, float ior = 1.5f) {
    Material m = material(MaterialKind::principled, 0.f, roughness);
    m.ior = ior;
    return m;
}

/// The BSDF of red light.
double value(const Material& m, const glm::vec3& o, const glm::vec3& i) {
    return TestedMaterial(device(), m).evaluate(o, {i.x, i.y, i.z}).values.at(0);
}

double fresnel_of_layer(double cosine, double eta) { return verify::fresnel_reference(cosine, eta); }
double cosine_to_facet(const glm::vec3& o, const glm::vec3& i) {
    return glm::dot(glm::dvec3(o), glm::normalize(glm::dvec3(o + i)));
}

const glm::vec3 outgoing_directions[] = {at_angle(0.3), at_angle(0.9, 1.2), at_angle(1.4, 2.5)};
const glm::vec3 incoming_directions[] = {at_angle(0.2, 2.0), at_angle(1.1, 4.0)};

/// Calls check(o, i, the BSDF of red light for each material).
template <class Check, class... Materials>
void for_directions(Check check, const Materials&... materials) {
    const TestedMaterial tested[] = {TestedMaterial(device(), materials)...};
    for (const glm::vec3& o : outgoing_directions)
        for (const glm::vec3& i : incoming_directions) {
            double values[sizeof...(materials)];
            for (std::size_t k = 0; k < sizeof...(materials); ++k)
                values[k] = double(tested[k].evaluate(o, {i.x, i.y, i.z}).values.at(0));
            check(o, i, values);
        }
}

/// KHR_materials_specular: F0 = min(0.04 tint, 1) weight and F90 = weight, by Fresnel's curve in between.
TEST(SpecularLayer, ScalesBothEndsOfFresnelsCurve) {
    for (const float ior : {1.5f, 1.2f})
        for (const auto& [weight, tint] : {std::pair{0.4f, 5.f}, {0.7f, 0.f}, {0.6f, 1000.f}, {0.f, 1.f}}) {
            const Material plain = interface_alone(0.5f, ior);
            Material m = plain;
            m.specular_weight = weight, m.specular_tint = glm::vec3(tint, 1.f, 1.f);
            for_directions(
                [&](const glm::vec3& o, const glm::vec3& i, const double* v) {
                    const double f = fresnel_of_layer(cosine_to_facet(o, i), double(ior)),
                                 f0 = fresnel_of_layer(1, double(ior));
                    const double f0_here = std::min(double(tint) * f0, 1.0);
                    const double expected = double(weight) * (f0_here + (1 - f0_here) * (f - f0) / (1 - f0));
                    EXPECT_NEAR(v[0] / v[1] * f, expected, 1e-4)
                        << "weight " << weight << ", tint " << tint << ", ior " << ior;
                },
                m, plain);
        }
}

TEST(SpecularLayer, OfOneIsNone) {
    Material m = material(MaterialKind::principled, 0.5f, 0.5f);
    const Material plain = m;
    m.specular_map.texture = 0;  // enables the layer, and multiplies by 1 here
    for_directions([](const glm::vec3&, const glm::vec3&, const double* v) { EXPECT_NEAR(v[0], v[1], 2e-3 * v[1]); }, m,
                   plain);
}

/// Heitz 2014, section 5.3, with the alphas of KHR_materials_anisotropy.
TEST(AnisotropicLayer, IsStretchedGgx) {
    for (const float roughness : {0.2f, 0.6f})
        for (const float strength : {0.3f, 1.f}) {
            Material m = interface_alone(roughness);
            m.anisotropy = strength;
            const double ay = double(roughness) * roughness, ax = ay + (1 - ay) * double(strength) * strength;
            const auto lambda = [&](const glm::vec3& v) {
                const double tangent2 = (std::pow(ax * v.x, 2) + std::pow(ay * v.y, 2)) / (double(v.z) * v.z);
                return 0.5 * (std::sqrt(1 + tangent2) - 1);
            };
            for_directions(
                [&](const glm::vec3& o, const glm::vec3& i, const double* v) {
                    const glm::dvec3 h = glm::normalize(glm::dvec3(o + i));
                    const double d =
                        1 / (pi * ax * ay * std::pow(std::pow(h.x / ax, 2) + std::pow(h.y / ay, 2) + h.z * h.z, 2));
                    const double expected = fresnel_of_layer(cosine_to_facet(o, i), 1.5) * d /
                                            (1 + lambda(o) + lambda(i)) / (4 * o.z * i.z);
                    EXPECT_NEAR(v[0] / expected, 1, 1e-4) << "roughness " << roughness << ", strength " << strength;
                },
                m);
        }
}

/// Estevez and Kulla 2017.
TEST(SheenLayer, IsCharlies) {
    for (const float roughness : {0.5f, 1.f}) {  // for these the published lobe reflects at most all light
        Material m = interface_alone(1.f);
        m.specular_weight = 0.f, m.sheen = {0.8f, 1.f, 0.1f}, m.sheen_roughness = roughness;
        const double alpha = double(roughness) * roughness, t = std::pow(1 - alpha, 2);
        const auto fit = [&](double x) {
            const double a = t * 25.3245 + (1 - t) * 21.5473, b = t * 3.32435 + (1 - t) * 3.82987,
                         c = t * 0.16801 + (1 - t) * 0.19823, d = t * -1.27393 + (1 - t) * -1.97760,
                         e = t * -4.85967 + (1 - t) * -4.32054;
            return a / (1 + b * std::pow(x, c)) + d * x + e;
        };
        const auto lambda = [&](double z) { return std::exp(z < 0.5 ? fit(z) : 2 * fit(0.5) - fit(1 - z)); };
        for_directions(
            [&](const glm::vec3& o, const glm::vec3& i, const double* v) {
                const double z = glm::normalize(glm::dvec3(o + i)).z;
                const double d = (2 + 1 / alpha) * std::pow(1 - z * z, 0.5 / alpha) / (2 * pi);
                const double expected = 0.8 * d / (1 + lambda(o.z) + lambda(i.z)) / (4 * double(o.z) * i.z);
                EXPECT_NEAR(v[0] / expected, 1, 1e-3) << "roughness " << roughness;
            },
            m);
    }
}

// ---- thin films ---------------------------------------------------------------------------------------------------

const Material plain_base = interface_alone(0.5f);

/// A cosine of 1 is rounded to more than 1, where the masking function is undefined.
TEST(SheenLayer, IsFiniteAlongTheNormal) {
    Material m = interface_alone(0.5f);
    m.sheen = glm::vec3(1.f), m.sheen_roughness = 0.5f;
    const TestedMaterial tested(device(), m);
    for (const float beyond : {1.f, std::nextafter(1.f, 2.f), 1.000001f}) {
        const glm::vec3 along(0.f, 0.f, beyond);
        const TestedMaterial::Evaluated found = tested.evaluate(along, {along.x, along.y, along.z});
        EXPECT_TRUE(std::isfinite(found.values.at(0))) << beyond;
        EXPECT_NEAR(found.values.at(0), value(m, at_angle(0.f), at_angle(0.f)), 1e-5) << beyond;
    }
}

Material film_of(float film_ior, float thickness, const Material& base = plain_base) {
    Material m = base;
    m.iridescence = 1.f, m.iridescence_ior = film_ior, m.film_thickness = glm::vec2(thickness);
    return m;
}

TEST(FilmLayer, OfNoThicknessOrNoShareIsNone) {
    const Material plain = material(MaterialKind::principled, 0.5f, 0.5f);
    Material thin = film_of(1.3f, 0.f, plain), absent = plain;
    absent.iridescence = 0.f;
    for_directions(
        [&](const glm::vec3& o, const glm::vec3& i, const double* v) {
            EXPECT_EQ(v[0], v[2]);
            EXPECT_EQ(v[1], v[2]);
            const double f = fresnel_of_layer(cosine_to_facet(o, i), 1.5);
            EXPECT_NEAR(v[3] / v[4] * f, f, 0.02) << "nearly none";
        },
        thin, absent, plain, film_of(1.3f, 1e-3f), plain_base);
}

/// Light of many wavelengths does not interfere: both borders reflect independently, back and forth.
TEST(FilmLayer, OfMuchThicknessIsAPane) {
    for (const float film_ior : {1.3f, 2.f})
        for_directions(
            [&](const glm::vec3& o, const glm::vec3& i, const double* v) {
                const double c = cosine_to_facet(o, i), n = double(film_ior),
                             within = std::sqrt(1 - (1 - c * c) / (n * n));
                const double outer = fresnel_of_layer(c, n),
                             inner = schlick(std::pow((1.5 - n) / (1.5 + n), 2), within);
                const double expected = outer + std::pow(1 - outer, 2) * inner / (1 - outer * inner);
                EXPECT_NEAR(v[0] / v[1] * fresnel_of_layer(c, 1.5), expected, 1e-4) << film_ior;
            },
            film_of(film_ior, 1e6f), plain_base);
}

/// The colour-matching functions of Wyman, Sloan and Shirley 2013, "Simple analytic approximations to the CIE XYZ color
/// matching functions".
glm::dvec3 matching(double wave) {
    const auto lobe = [&](double height, double at, double below, double above) {
        const double x = (wave - at) * (wave < at ? below : above);
        return height * std::exp(-0.5 * x * x);
    };
    return {lobe(1.056, 599.8, 1 / 37.9, 1 / 31.0) + lobe(0.362, 442.0, 1 / 16.0, 1 / 26.7) -
                lobe(0.065, 501.1, 1 / 20.4, 1 / 26.2),
            lobe(0.821, 568.8, 1 / 46.9, 1 / 40.5) + lobe(0.286, 530.9, 1 / 16.3, 1 / 31.1),
            lobe(1.217, 437.0, 1 / 11.8, 1 / 36.0) + lobe(0.681, 459.0, 1 / 26.0, 1 / 13.8)};
}

/// Airy's formula per wavelength, integrated to a channel of linear Rec. 709, for grey light and Schlick's curve
/// inside.
double airy(double base_ior, double film_ior, double thickness, int channel = 0, double cosine = 1) {
    constexpr double rows[3][3] = {
        {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};
    const glm::dvec3 row(rows[channel][0], rows[channel][1], rows[channel][2]);
    const double within = std::sqrt(1 - (1 - cosine * cosine) / (film_ior * film_ior));
    const double contrast = (film_ior - base_ior) / (film_ior + base_ior);
    const double a = std::copysign(std::sqrt(fresnel_of_layer(cosine, film_ior)), 1 - film_ior),
                 b = std::copysign(std::sqrt(schlick(contrast * contrast, within)), contrast);
    const double mean = a * a + std::pow(1 - a * a, 2) * b * b / (1 - a * a * b * b);
    double sum = 0, whole = 0;
    for (double wave = 380; wave < 780; wave += 0.5) {
        const auto turned = std::polar(1.0, 4 * pi * film_ior * thickness * within / wave);
        const double reflected = std::norm((a + b * turned) / (1.0 + a * b * turned));
        const glm::dvec3 xyz = matching(wave);
        sum += (reflected - mean) * glm::dot(row, xyz), whole += xyz.y;
    }
    return std::clamp(mean + sum / whole, 0.0, 1.0);
}

TEST(FilmLayer, InterferesAsAirySays) {
    const glm::vec3 up(0.f, 0.f, 1.f);
    for (const float base_ior : {1.5f, 2.2f}) {
        const Material plain = interface_alone(0.5f, base_ior);
        const double of_plain = value(plain, up, up) / fresnel_of_layer(1, double(base_ior));
        for (const float film_ior : {1.3f, 1.8f})
            for (const float thickness : {50.f, 120.f, 280.f, 400.f, 800.f})
                EXPECT_NEAR(value(film_of(film_ior, thickness, plain), up, up) / of_plain,
                            airy(double(base_ior), double(film_ior), double(thickness)), 0.012)
                    << thickness << " nm of " << film_ior << " on " << base_ior;
        const glm::vec3 o = at_angle(0.9), i(-o.x, -o.y, o.z);
        const double plain_aside = value(plain, o, i) / fresnel_of_layer(double(o.z), double(base_ior));
        for (const float thickness : {120.f, 280.f, 400.f})
            EXPECT_NEAR(value(film_of(1.3f, thickness, plain), o, i) / plain_aside,
                        airy(double(base_ior), 1.3, double(thickness), 0, double(o.z)), 0.012)
                << thickness << " nm seen aside on " << base_ior;
    }
}

// ---- extremes -----------------------------------------------------------------------------------------------------

TEST(Layers, AreFiniteAtTheEnds) {
    for (const float roughness : {0.f, 1.f})
        for (const float end : {0.f, 1.f})
            for (const float ior : {1.f, 100.f}) {
                Material m = material(MaterialKind::principled, 1.f, roughness);
                m.ior = ior, m.specular_weight = end, m.specular_tint = glm::vec3(1e6f * end);
                m.sheen = glm::vec3(1.f), m.sheen_roughness = roughness, m.anisotropy = 1.f;
                m.iridescence = 0.5f + 0.5f * end, m.iridescence_ior = end == 0.f ? 1.f : ior;
                m.film_thickness = glm::vec2(end == 0.f ? 1e-20f : 1e9f);
                m.clearcoat = 1.f, m.clearcoat_roughness = roughness;
                for (const float metallic : {0.f, 1.f}) {
                    m.metallic = metallic;
                    for (const double angle : {0.0, 0.7, 1.5707, 1.57079})
                        for (const verify::Sampled& s : TestedMaterial(device(), m).draw(at_angle(angle), 500)) {
                            if (!s.valid) continue;
                            ASSERT_TRUE(std::isfinite(s.weight) && s.weight >= 0 && std::isfinite(s.pdf) && s.pdf >= 0)
                                << s.weight << " " << s.pdf << ", angle " << angle;
                            ASSERT_TRUE(std::isfinite(s.eval_value) && std::isfinite(s.eval_pdf)) << "angle " << angle;
                        }
                }
            }
}

// ---- scenes -------------------------------------------------------------------------------------------------------

const RenderConfig layer_config{.width = 4, .height = 4, .spp = 16, .max_depth = 2};

/// A mapped square below a directional light, seen from a direction of the upper half space.
Scene lit_square(const Material& m, const glm::vec3& towards_viewer, const glm::vec3& towards_light) {
    Scene scene;
    scene.materials = {m};
    scene.meshes = {mapped_square()};
    Light light;
    light.kind = LightKind::directional, light.direction = -towards_light, light.intensity = glm::vec3(1.f);
    scene.lights = {light};
    scene.camera = narrow_camera(2.f * towards_viewer, {0, 0, 0});
    return scene;
}

/// In the square's frame x is along u, y towards the image's top, z up.
glm::vec3 to_square(const glm::vec3& v) { return {v.x, v.z, -v.y}; }
glm::vec3 turned(const glm::vec3& v, float angle) {
    return {std::cos(angle) * v.x + std::sin(angle) * v.y, std::cos(angle) * v.y - std::sin(angle) * v.x, v.z};
}

/// Films of every colour on a base that reflects so much that the second harmonic matters.
TEST(FilmLayer, InterferesOnMetalInAllColours) {
    Material metal = material(MaterialKind::principled, 0.8f, 0.3f);
    metal.metallic = 1.f;
    const double root = std::sqrt(0.8), base_ior = (1 + root) / (1 - root);
    const auto seen = [](const Material& m) {
        return mean(render_image(lit_square(m, {0, 1, 0}, {0, 1, 0}), layer_config));
    };
    const double of_all = seen(metal).x / 0.8;
    for (const float thickness : {50.f, 120.f, 280.f}) {
        const glm::dvec3 reflected = seen(film_of(1.8f, thickness, metal)) / of_all;
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(reflected[k], airy(base_ior, 1.8, double(thickness), k), 0.025)
                << thickness << " nm, channel " << k;
    }
}

/// Highlights are stretched along the tangent; rotation and texture turn it counter-clockwise.
TEST(AnisotropicLayer, FollowsTangentRotationAndTexture) {
    Material m = interface_alone(0.5f);
    m.anisotropy = 0.8f;
    const glm::vec3 o = at_angle(0.5, 0.4), i = at_angle(0.9, 2.9);
    const auto expected = [&](float angle) { return value(m, turned(o, angle), turned(i, angle)) * double(i.z); };
    Scene scene = lit_square(m, to_square(o), to_square(i));
    EXPECT_NEAR(mean(render_image(scene, layer_config)).x / expected(0.f), 1, 1e-3);
    scene.materials[0].anisotropy_rotation = -5.f;
    EXPECT_NEAR(mean(render_image(scene, layer_config)).x / expected(-5.f), 1, 1e-3);
    const float angle = 0.7f;
    scene.textures = {float_texture({1, 1}, [&](double, double) {
        return glm::vec3(0.5f + 0.5f * std::cos(angle), 0.5f + 0.5f * std::sin(angle), 0.75f);
    })};
    scene.materials[0].anisotropy_map.texture = 0;
    m.anisotropy *= 0.75f;
    EXPECT_NEAR(mean(render_image(scene, layer_config)).x / expected(-5.f + angle), 1, 1e-3);
    scene.materials[0].anisotropy_rotation = 0.f;
    for (const float side : {1.f, -1.f}) {  // the tangent is the image's top, the bitangent towards -u or u
        scene.meshes[0].tangents.assign(4, {0.f, 0.f, -1.f, side});
        EXPECT_NEAR(mean(render_image(scene, layer_config)).x / expected(float(pi / 2) + side * angle), 1, 1e-3)
            << side;
    }
}

/// Under a sky that is linear in height a smooth coat shows the direction that it reflects.
TEST(LayeredCoat, LiesOnNormalsOfItsOwn) {
    Scene scene;
    scene.textures = {float_texture({1, 1}, [](double, double) { return glm::vec3(0.8f, 0.5f, 0.9f); })};
    Material m = interface_alone(1.f);
    m.specular_weight = 0.f, m.clearcoat = 1.f, m.normal_map.texture = 0;
    scene.materials = {m};
    scene.meshes = {mapped_square()};
    scene.sky = {glm::vec3(0.f), glm::vec3(1.f)};
    const glm::vec3 towards_viewer = glm::normalize(glm::vec3(0.3f, 1.f, 0.2f));
    scene.camera = narrow_camera(2.f * towards_viewer, {0, 0, 0});
    const auto expected = [&](const glm::dvec3& normal) {
        const double c = glm::dot(normal, glm::dvec3(towards_viewer));
        return fresnel_of_layer(c, 1.5) * (2 * c * normal.y - double(towards_viewer.y));
    };
    RenderConfig many = layer_config;
    many.spp = 4096;
    EXPECT_NEAR(mean(render_image(scene, many)).x / expected({0, 1, 0}), 1, 0.02) << "that of the mesh";
    scene.materials[0].clearcoat_normal_map.texture = 0;
    EXPECT_NEAR(mean(render_image(scene, many)).x / expected({0.6, 0.8, 0}), 1, 0.02);
    scene.materials[0].clearcoat_normal_scale = 0.5f;
    EXPECT_NEAR(mean(render_image(scene, many)).x / expected(glm::normalize(glm::dvec3(0.3, 0.8, 0))), 1, 0.02);
}

/// It shows its base colour in any light, to the camera and in mirrors, and lights nothing.
TEST(Unlit, ShowsItsColorAndLightsNothing) {
    Scene scene = lit_square(material(MaterialKind::unlit, 0.25f), {0, 1, 0}, glm::normalize(glm::vec3(1, 1, 0)));
    EXPECT_EQ(mean(render_image(scene, layer_config)).x, 0.25);
    scene.lights.clear();
    EXPECT_EQ(mean(render_image(scene, layer_config)).x, 0.25) << "without light";
    scene.materials.push_back(material(MaterialKind::mirror, 0.5f));
    scene.meshes.push_back(square(1.f, 3.f, 1));
    scene.camera = narrow_camera({0.1f, 1.f, 0.f}, {0.1f, 3.f, 0.f});
    EXPECT_EQ(mean(render_image(scene, layer_config)).x, 0.125) << "in a mirror";
    scene.materials[1] = lambert(0.5f);
    EXPECT_EQ(mean(render_image(scene, layer_config)).x, 0.0) << "is no lamp";
    scene.textures = {float_texture({1, 1}, [](double, double) { return 0.5; })};
    scene.materials[0].albedo_map.texture = 0;
    scene.camera = narrow_camera({0.1f, 1.f, 0.f}, {0.1f, 0.f, 0.f});
    EXPECT_EQ(mean(render_image(scene, layer_config)).x, 0.125) << "textured";
}

/// Each channel equals that of a grey layer of its value.
TEST(Layers, HaveThreeColours) {
    Material tinted = interface_alone(0.5f), sheen = interface_alone(1.f);
    tinted.specular_tint = {4.f, 2.f, 1.5f};
    sheen.specular_weight = 0.f, sheen.sheen = {0.8f, 0.4f, 0.1f}, sheen.sheen_roughness = 0.7f;
    const glm::vec3 o = to_square(at_angle(0.5)), i = to_square(at_angle(0.7, 3.0));
    const auto seen = [&](const Material& m) { return mean(render_image(lit_square(m, o, i), layer_config)); };
    const glm::dvec3 of_tinted = seen(tinted), of_sheen = seen(sheen);
    for (int k = 0; k < 3; ++k) {
        Material grey = tinted;
        grey.specular_tint = glm::vec3(tinted.specular_tint[k]);
        EXPECT_NEAR(of_tinted[k] / seen(grey)[k], 1, 1e-4) << k;
        EXPECT_NEAR(of_sheen[k] / of_sheen.x, double(sheen.sheen[k] / sheen.sheen.x), 1e-4) << k;
    }
}

/// Each map reads the channels that glTF specifies.
TEST(LayerMaps, OfOneValueAreFactors) {
    Texture texture = float_texture({1, 1}, [](double, double) { return 0.0; });
    texture.channels = 4, texture.floats = {0.25f, 0.5f, 0.75f, 0.625f};
    Material base = material(MaterialKind::principled, 0.3f, 0.5f);
    base.specular_tint = glm::vec3(4.f), base.sheen = glm::vec3(0.8f), base.sheen_roughness = 0.9f;
    base.iridescence = 1.f, base.film_thickness = {100.f, 500.f};
    Material phong = material(MaterialKind::blinn_phong, 0.2f);
    phong.specular = glm::vec3(0.4f), phong.shininess = 20.f;
    struct Case {
        const char* name;
        const Material& base;
        TextureUse Material::*map;
        void (*multiply)(Material&);
    };
    const Case cases[] = {
        {"specular colour", base, &Material::specular_map,
         [](Material& m) { m.specular_tint *= glm::vec3(0.25f, 0.5f, 0.75f); }},
        {"specular", base, &Material::specular_weight_map, [](Material& m) { m.specular_weight *= 0.625f; }},
        {"sheen colour", base, &Material::sheen_map, [](Material& m) { m.sheen *= glm::vec3(0.25f, 0.5f, 0.75f); }},
        {"sheen roughness", base, &Material::sheen_roughness_map, [](Material& m) { m.sheen_roughness *= 0.625f; }},
        {"iridescence", base, &Material::iridescence_map, [](Material& m) { m.iridescence *= 0.25f; }},
        {"film thickness", base, &Material::film_thickness_map, [](Material& m) { m.film_thickness.y = 300.f; }},
        {"Ks", phong, &Material::specular_map, [](Material& m) { m.specular *= glm::vec3(0.25f, 0.5f, 0.75f); }},
        {"Ns", phong, &Material::shininess_map, [](Material& m) { m.shininess *= 0.25f; }},
    };
    const glm::vec3 o = to_square(at_angle(0.5)), i = to_square(at_angle(0.7, 3.0));
    RenderConfig many = layer_config;
    many.spp = 256;
    for (const Case& one : cases) {
        Scene multiplied = lit_square(one.base, o, i);
        multiplied.textures = {texture};
        one.multiply(multiplied.materials[0]);
        Scene mapped = lit_square(one.base, o, i);
        mapped.textures = {texture};
        mapped.materials[0].*one.map = {.texture = 0};
        const glm::dvec3 a = mean(render_image(mapped, many)), b = mean(render_image(multiplied, many));
        const glm::dvec3 plain = mean(render_image(lit_square(one.base, o, i), many));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-4 * b[k]) << one.name;
        EXPECT_GT(glm::length(a - plain), 1e-3 * glm::length(plain)) << one.name;
    }
}

/// Diffuse and highlight are scaled down, texel by texel, if both together reflect more than all light.
TEST(LayerMaps, BlinnPhongKeepsEnergyPerTexel) {
    Material m = material(MaterialKind::blinn_phong, 1.f);
    m.specular = glm::vec3(0.5f), m.shininess = 20.f;
    const glm::vec3 o = to_square(at_angle(0.5)), i = to_square(at_angle(0.7, 3.0));
    const auto seen = [&](double texel, float albedo, float specular) {
        Scene scene = lit_square(m, o, i);
        scene.textures = {float_texture({1, 1}, [=](double, double) { return texel; })};
        scene.materials[0].albedo_map.texture = 0;
        Scene plain = lit_square(m, o, i);
        plain.materials[0].albedo = glm::vec3(albedo), plain.materials[0].specular = glm::vec3(specular);
        const glm::dvec3 ratio = mean(render_image(scene, layer_config)) / mean(render_image(plain, layer_config));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(ratio[k], 1, 1e-5) << texel << ", channel " << k;
    };
    seen(0.25, 0.25f, 0.5f);
    seen(1.0, 2.f / 3, 1.f / 3);
    Material kept = m;
    kept.albedo = glm::vec3(2.f / 3), kept.specular = glm::vec3(1.f / 3);
    const auto image_of = [&](const Material& one) { return mean(render_image(lit_square(one, o, i), layer_config)); };
    EXPECT_NEAR(image_of(m).x, image_of(kept).x, 1e-6) << "without a texture";
}

}  // namespace
}  // namespace claray::test
