// Every material in a scene whose radiance is known: in closed form, or integrated in float64 by formulas that share
// nothing with the kernels.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "host/verify/cases/rendering/bsdf.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

// ---- reference ----------------------------------------------------------------------------------------------------

struct Ggx {
    double alpha;
    [[nodiscard]] double d(const glm::dvec3& h) const {
        const double t2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);  // Walter et al. 2007, equation 33
        return alpha * alpha / (pi * std::pow(h.z, 4) * std::pow(alpha * alpha + t2, 2));
    }
    [[nodiscard]] double lambda(double z) const {
        return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - z * z) / (z * z)) - 1);
    }
    [[nodiscard]] double reflection(const glm::dvec3& o, const glm::dvec3& i) const {
        return d(glm::normalize(o + i)) / (1 + lambda(o.z) + lambda(i.z)) / (4 * o.z * i.z);
    }
};

/// Shares of light from a direction that are reflected and transmitted by one microfacet, by the midpoint rule over the
/// distribution of normals.
struct Once {
    double reflected = 0, transmitted = 0;
};
Once scattered_once(double z, double alpha, const std::function<double(double)>& reflectance, double eta) {
    const Ggx ggx{alpha};
    const double x = std::sqrt(1 - z * z);
    const int n = 300;
    Once once;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
            const double u = (a + 0.5) / n, phi = 2 * pi * (b + 0.5) / n;
            const double hz = 1 / std::sqrt(1 + alpha * alpha * u / (1 - u));
            const double oh = x * std::sqrt(1 - hz * hz) * std::cos(phi) + z * hz;
            if (oh <= 0) continue;
            const double weight = oh / (z * hz) / n / n, f = reflectance(oh), iz = 2 * oh * hz - z;
            if (iz > 0) once.reflected += weight * f / (1 + ggx.lambda(z) + ggx.lambda(iz));
            const double t2 = 1 - (1 - oh * oh) / (eta * eta);
            if (t2 <= 0) continue;
            const double tz = (oh / eta - std::sqrt(t2)) * hz - z / eta;
            if (tz < 0) once.transmitted += weight * (1 - f) / (1 + ggx.lambda(z)) / (1 + ggx.lambda(-tz));
        }
    return once;
}

/// A function of the cosine, sampled and interpolated, and its average over the hemisphere.
class Curve {
public:
    explicit Curve(const std::function<double(double)>& f) {
        for (int i = 0; i <= n; ++i) values_.push_back(f(std::max(1e-3, std::pow(double(i) / n, 2))));
        const int steps = 2000;
        for (int i = 0; i < steps; ++i) average += 2 * (i + 0.5) / steps * (*this)((i + 0.5) / steps) / steps;
    }
    double operator()(double z) const {
        const double at = std::sqrt(z) * n;
        const int i = std::min(int(at), n - 1);
        return values_[i] + (at - i) * (values_[i + 1] - values_[i]);
    }
    double average = 0;

private:
    static constexpr int n = 32;
    std::vector<double> values_;
};

/// The integral of f(i) * cos(i) * sky(i) over the hemisphere, for directions in local coordinates.
double integrate_under(const std::function<double(const glm::dvec3&)>& f, const Sky& sky) {
    const int n = 600;
    double sum = 0;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
            const double z2 = (a + 0.5) / n, phi = 2 * pi * (b + 0.5) / n, s = std::sqrt(1 - z2), z = std::sqrt(z2);
            const glm::dvec3 i(s * std::cos(phi), s * std::sin(phi), z);
            sum += f(i) * (sky.horizon.x + (sky.zenith.x - sky.horizon.x) * z);
        }
    return sum * pi / n / n;
}

// ---- scenes -------------------------------------------------------------------------------------------------------

const Sky sky{glm::vec3(0.2f), glm::vec3(3.f)};
const RenderConfig one_surface{.width = 8, .height = 8, .spp = 2048, .max_depth = 1};

glm::dvec3 direction(double angle) { return {std::sin(angle), 0, std::cos(angle)}; }

Scene plane(const Material& material, double angle) {
    Scene scene;
    scene.materials = {material};
    scene.meshes = {square(10.f, 0.f)};
    scene.camera = narrow_camera({0, 2 * std::cos(angle), 2 * std::sin(angle)}, {0, 0, 0});
    scene.sky = sky;
    return scene;
}

/// Within 3 standard errors and 0.5 %, plus the errors of float32 and of tables.
void expect_radiance(const Scene& scene, const RenderConfig& with, double expected, const std::string& what) {
    const std::vector<glm::vec3> image = render_image(scene, with);
    const double average = mean(image).x;
    double squares = 0;
    for (const glm::vec3& pixel : image) squares += std::pow(double(pixel.x) - average, 2);
    const double error = std::sqrt(squares / double(image.size()) / double(image.size() - 1));
    EXPECT_NEAR(average, expected, 3 * error + 2e-4 * expected) << what;
    EXPECT_NEAR(average / expected, 1, 0.005) << what;
}

TEST(MaterialScene, BlinnPhong) {
    Material m = material(MaterialKind::blinn_phong, 0.4f);
    m.specular = glm::vec3(0.5f), m.shininess = 20.f;
    for (const double angle : {0.2, 1.0}) {
        const glm::dvec3 o = direction(angle);
        const double norm = 22.0 * 24 / (8 * pi * (std::pow(2, -10) + 20));
        const auto f = [&](const glm::dvec3& i) {
            return 0.4 / pi + 0.5 * norm * std::pow(glm::normalize(o + i).z, 20);
        };
        expect_radiance(plane(m, angle), one_surface, integrate_under(f, sky), "angle " + std::to_string(angle));
    }
}

TEST(MaterialScene, RoughMetalWithAllItsReflections) {
    for (const float roughness : {0.5f, 0.9f}) {
        const double alpha = double(roughness) * roughness, f0 = 0.6;
        const auto all = [](double) { return 1.0; };
        const Curve lost([&](double z) { return 1 - scattered_once(z, alpha, all, 1).reflected; });
        const double average = f0 + (1 - f0) / 21;  // Kulla and Conty 2017: every further reflection is tinted
        const double tint = average * average * (1 - lost.average) / (1 - average * lost.average);
        for (const double angle : {0.2, 1.2}) {
            const glm::dvec3 o = direction(angle);
            const auto f = [&](const glm::dvec3& i) {
                return schlick(f0, glm::dot(o, glm::normalize(o + i))) * Ggx{alpha}.reflection(o, i) +
                       tint * lost(o.z) * lost(i.z) / (pi * lost.average);
            };
            expect_radiance(plane(material(MaterialKind::metal, 0.6f, roughness), angle), one_surface,
                            integrate_under(f, sky),
                            "roughness " + std::to_string(roughness) + ", angle " + std::to_string(angle));
        }
    }
}

/// Transmittance of an interface of this roughness and index of refraction.
Curve let_through(double alpha, double ior) {
    const auto reflectance = [ior](double c) { return verify::fresnel_reference(c, ior); };
    return Curve([&](double z) { return 1 - scattered_once(z, alpha, reflectance, ior).reflected; });
}

/// An interface over a diffuse base.
TEST(MaterialScene, Plastic) {
    const double alpha = 0.4 * 0.4, albedo = 0.5;
    const Curve entered = let_through(alpha, 1.5);
    for (const double angle : {0.2, 1.2}) {
        const glm::dvec3 o = direction(angle);
        const auto f = [&](const glm::dvec3& i) {
            return verify::fresnel_reference(glm::dot(o, glm::normalize(o + i)), 1.5) * Ggx{alpha}.reflection(o, i) +
                   albedo * entered(o.z) * entered(i.z) / (pi * entered.average);
        };
        expect_radiance(plane(material(MaterialKind::principled, 0.5f, 0.4f), angle), one_surface,
                        integrate_under(f, sky), "angle " + std::to_string(angle));
    }
}

/// A rough coat over a smooth interface over a diffuse base: both reflect, and the remaining light enters the base.
TEST(MaterialScene, CoatedPlastic) {
    const double alpha = 0.4 * 0.4, albedo = 0.5;
    const Curve passed = let_through(alpha, 1.5);
    const Curve entered([&](double z) { return passed(z) * (1 - verify::fresnel_reference(z, 1.7)); });
    Material coated = material(MaterialKind::principled, 0.5f, 0.f);
    coated.ior = 1.7f, coated.clearcoat = 1.f, coated.clearcoat_roughness = 0.4f;
    for (const double angle : {0.2, 1.2}) {
        const glm::dvec3 o = direction(angle);
        const auto f = [&](const glm::dvec3& i) {
            return verify::fresnel_reference(glm::dot(o, glm::normalize(o + i)), 1.5) * Ggx{alpha}.reflection(o, i) +
                   albedo * entered(o.z) * entered(i.z) / (pi * entered.average);
        };
        const double mirrored = passed(o.z) * verify::fresnel_reference(o.z, 1.7) * (0.2 + 2.8 * o.z);
        expect_radiance(plane(coated, angle), one_surface, integrate_under(f, sky) + mirrored,
                        "angle " + std::to_string(angle));
    }
}

/// Mirrors with half a coat: the coat reflects, and the metal reflects the remaining light.
TEST(MaterialScene, SmoothCoatOverSmoothMetal) {
    for (const double angle : {0.2, 1.2}) {
        Material m = material(MaterialKind::principled, 0.6f, 0.f);
        m.metallic = 1.f, m.clearcoat = 0.5f;
        const double z = std::cos(angle), coat = verify::fresnel_reference(z, 1.5), metal = schlick(double(0.6f), z);
        const double expected = 0.5 * metal + 0.5 * (coat + (1 - coat) * metal);
        const double light = 0.2 + 2.8 * z;
        expect_radiance(plane(m, angle), one_surface, expected * light, "angle " + std::to_string(angle));
    }
}

/// A point light on either side of one rough interface, seen from outside and from inside.
TEST(MaterialScene, RoughGlassLitFromBothSides) {
    const double alpha = 0.5 * 0.5, eta = 1.5;
    Curve lost[2] = {Curve([&](double z) {
                         const Once once = scattered_once(
                             z, alpha, [&](double c) { return verify::fresnel_reference(c, eta); }, eta);
                         return 1 - once.reflected - once.transmitted;
                     }),
                     Curve([&](double z) {
                         const Once once = scattered_once(
                             z, alpha, [&](double c) { return verify::fresnel_reference(c, 1 / eta); }, 1 / eta);
                         return 1 - once.reflected - once.transmitted;
                     })};
    const Curve passed([&](double z) { return 1 - verify::fresnel_reference(z, eta); });
    for (const bool inside : {false, true})
        for (const double towards : {0.4, 0.9, pi - 0.4, pi - 0.7}) {
            const bool through = towards > pi / 2;
            const glm::dvec3 o = direction(0.6), i(-std::sin(towards), 0, std::cos(towards));
            const double beyond = inside ? 1 / eta : eta;  // index on the other side over the one on the viewer's
            double f = 0;
            if (through) {  // Walter et al. 2007, equation 21, for radiance over the square of the index
                glm::dvec3 h = glm::normalize(-(o + beyond * i));
                if (h.z < 0) h = -h;
                const double oh = glm::dot(o, h), ih = glm::dot(i, h), sum = oh + beyond * ih;
                const Ggx ggx{alpha};
                if (oh > 0 && ih < 0)
                    f = oh * -ih / (o.z * -i.z) * beyond * beyond * (1 - verify::fresnel_reference(oh, beyond)) *
                        ggx.d(h) / (1 + ggx.lambda(o.z)) / (1 + ggx.lambda(-i.z)) / (sum * sum);
            } else {
                f = verify::fresnel_reference(glm::dot(o, glm::normalize(o + i)), beyond) * Ggx{alpha}.reflection(o, i);
            }
            const Curve &here = lost[inside], &there = lost[!inside];
            const double crossing =
                passed.average * (inside ? 1 / (eta * eta) : 1) * there.average / std::max(here.average, there.average);
            f += through ? crossing * here(o.z) * there(-i.z) / (pi * there.average)
                         : (1 - crossing) * here(o.z) * here(i.z) / (pi * here.average);

            Scene scene = plane(material(MaterialKind::glass, 1.f, 0.5f), 0.6);
            scene.sky = {};
            if (inside)
                for (glm::uvec3& t : scene.meshes[0].triangles) std::swap(t.y, t.z);
            // Local x is the world's z, and z its y.
            scene.lights = {point_light({0.f, float(2 * i.z), float(2 * i.x)}, glm::vec3(5.f))};
            const double radiance = mean(render_image(scene, {.width = 4, .height = 4, .spp = 4, .max_depth = 1})).x;
            // In addition to 0.5 % the error of tables: lost light is known to 0.1 % of all light.
            EXPECT_NEAR(radiance / (std::abs(i.z) * 5 / 4), f, 0.005 * f + 0.001 / pi)
                << (inside ? "inside, " : "outside, ") << "towards " << towards;
        }
}

/// A slab of smooth glass that absorbs: all orders of reflection within it, in closed form.
TEST(MaterialScene, GlassSlabAbsorbs) {
    for (const double angle : {0.0, 0.7, 1.2}) {
        Material m = material(MaterialKind::glass, 1.f);
        m.attenuation = {0.5f, 1.f, 0.f}, m.attenuation_distance = 0.8f;
        Scene scene = plane(m, angle);
        scene.meshes = {square(200.f, 0.f), square(200.f, -1.f)};
        for (glm::uvec3& t : scene.meshes[1].triangles) std::swap(t.y, t.z);
        const double z = std::cos(angle), f = verify::fresnel_reference(z, 1.5),
                     inner = std::sqrt(1 - (1 - z * z) / 2.25);
        const double left = std::pow(0.5, 1 / inner / 0.8), loop = 1 - f * f * left * left;
        const double reflected = f + (1 - f) * (1 - f) * f * left * left / loop;
        const double transmitted = (1 - f) * (1 - f) * left / loop;
        const double expected = reflected * (0.2 + 2.8 * z) + transmitted * 0.2;
        const RenderConfig deep{.width = 16, .height = 16, .spp = 4096, .max_depth = 64};
        expect_radiance(scene, deep, expected, "angle " + std::to_string(angle));
        const glm::dvec3 all = mean(render_image(scene, {.width = 16, .height = 16, .spp = 1024, .max_depth = 64}));
        const double clear = f + (1 - f) * (1 - f) * f / (1 - f * f);
        EXPECT_NEAR(all.y / (clear * (0.2 + 2.8 * z) + (1 - clear) * 0.2), 1, 0.01) << "what is not absorbed";
        EXPECT_NEAR(all.z / (f * (0.2 + 2.8 * z)), 1, 0.03) << "what is absorbed completely";
    }
}

/// Light goes straight on through a smooth wall, whichever side it comes from: a small lamp is seen where it is, by
/// what Fresnel's equations let through, tinted; a solid's border would bend the ray past it.
TEST(MaterialScene, ThinWallsDoNotBendLight) {
    for (const double angle : {0.2, 1.1})
        for (const bool turned : {false, true})
            for (const MaterialKind kind : {MaterialKind::glass, MaterialKind::principled}) {
                Scene scene;
                scene.materials = {material(kind, 0.6f), emitter(2.f)};
                Material& wall = scene.materials[0];
                wall.ior = 1.5f, wall.thin_walled = true, wall.transmission = 1.f;
                const glm::vec3 from(float(std::sin(angle)), float(std::cos(angle)), 0.f);
                scene.meshes = {square(5.f, 0.f), square(0.02f, 0.f, 1)};
                if (turned)
                    for (glm::uvec3& t : scene.meshes[0].triangles) std::swap(t.y, t.z);
                for (glm::vec3& p : scene.meshes[1].positions) p -= from;
                scene.camera = narrow_camera(from, {0, 0, 0});
                const double expected = 2 * 0.6 * (1 - verify::fresnel_reference(std::cos(angle), 1.5));
                const RenderConfig twice{.width = 16, .height = 16, .spp = 1024, .max_depth = 2};
                EXPECT_NEAR(mean(render_image(scene, twice)).x / expected, 1, 0.005)
                    << angle << (turned ? " turned" : "");
            }
}

/// Emissive triangles behind rough glass, or a rough wall, are found by both kinds of sampling; the weights add up
/// to 1.
TEST(MaterialScene, LampsAllAroundRoughGlassEqualASky) {
    for (const bool thin : {false, true}) {
        Material glass = material(MaterialKind::glass, 1.f, 0.5f);
        glass.thin_walled = thin;
        const double radiance =
            mean(render_image(among_lamps(glass), {.width = 8, .height = 8, .spp = 1024, .max_depth = 1})).x;
        EXPECT_NEAR(radiance, 1, 0.01) << (thin ? "thin" : "solid");
    }
}

}  // namespace
}  // namespace claray::test
