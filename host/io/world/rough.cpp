#include "host/io/world/rough.hpp"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "host/io/world/spectrum.hpp"

namespace claray {
namespace {

/// Smith's masking (Walter et al. 2007, equations 34 and 35 with the error function).
double masking(double cosine, const Facets& facets) {
    const double c = std::abs(cosine), tangent2 = (1 - c * c) / std::max(c * c, 1e-12);
    const double slope2 = facets.alpha * facets.alpha * tangent2;
    if (!facets.beckmann) return 2 / (1 + std::sqrt(1 + slope2));
    const double a = 1 / std::sqrt(std::max(slope2, 1e-12));
    return 2 / (1 + std::erf(a) + std::exp(-a * a) / (a * std::sqrt(std::numbers::pi)));
}

/// A facet of Beckmann's distribution, whether or not it is seen.
glm::dvec3 beckmann_facet(double alpha, double u, double v) {
    const double tangent = alpha * std::sqrt(-std::log1p(-u)), angle = 2 * std::numbers::pi * v;
    return glm::normalize(glm::dvec3(tangent * std::cos(angle), tangent * std::sin(angle), 1));
}

/// A facet that is seen from `from` (Heitz 2018, "Sampling the GGX distribution of visible normals").
glm::dvec3 visible_facet(const glm::dvec3& from, double alpha, double u, double v) {
    const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * from.x, alpha * from.y, from.z));
    const double across2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const glm::dvec3 a =
        across2 > 1e-18 ? glm::dvec3(-stretched.y, stretched.x, 0) / std::sqrt(across2) : glm::dvec3(1, 0, 0);
    const glm::dvec3 b = glm::cross(stretched, a);
    const double radius = std::sqrt(u), angle = 2 * std::numbers::pi * v, x = radius * std::cos(angle),
                 s = 0.5 * (1 + stretched.z);
    const double y = (1 - s) * std::sqrt(std::max(0.0, 1 - x * x)) + s * radius * std::sin(angle);
    const glm::dvec3 h = x * a + y * b + std::sqrt(std::max(0.0, 1 - x * x - y * y)) * stretched;
    return glm::normalize(glm::dvec3(alpha * h.x, alpha * h.y, std::max(1e-9, h.z)));
}

/// Calls weigh(from, facet, share), for directions of diffuse light and the facets that these see.
template <class Weigh>
void for_each_facet(const Facets& facets, const Weigh& weigh) {
    constexpr int angles = 32, side = 24;
    for (int i = 0; i < angles; ++i) {
        const double cosine = std::sqrt((i + 0.5) / angles);  // equal shares of diffuse light
        const glm::dvec3 from(std::sqrt(1 - cosine * cosine), 0, cosine);
        for (int k = 0; k < side * side; ++k) {
            const double u = (k % side + 0.5) / side, v = (k / side + 0.5) / side, share = 1.0 / (angles * side * side);
            if (!facets.beckmann) {
                weigh(from, visible_facet(from, facets.alpha, u, v), share);
                continue;
            }
            const glm::dvec3 facet = beckmann_facet(facets.alpha, u, v);
            const double seen = std::max(glm::dot(from, facet), 0.0) / (from.z * facet.z);
            weigh(from, facet, share * seen * masking(from.z, facets));
        }
    }
}

}  // namespace

RoughBorder rough_border(double ior, const Facets& facets) {
    RoughBorder border{0, 0};
    for_each_facet(facets, [&](const glm::dvec3& from, const glm::dvec3& facet, double weight) {
        const double cosine = glm::dot(from, facet);
        if (cosine <= 0) return;
        const double sine2 = (1 - cosine * cosine) / (ior * ior),
                     reflectance = sine2 >= 1 ? 1 : conductor_reflectance(ior, 0, cosine);
        const glm::dvec3 mirrored = 2 * cosine * facet - from;
        if (mirrored.z > 0) border.reflected += weight * reflectance * masking(mirrored.z, facets);
        if (sine2 >= 1) return;
        const glm::dvec3 refracted = (cosine / ior - std::sqrt(1 - sine2)) * facet - from / ior;
        if (refracted.z < 0) border.passed += weight * (1 - reflectance) * masking(refracted.z, facets);
    });
    return border;
}

double kept_by_facets(const Facets& facets) {
    double kept = 0;
    for_each_facet(facets, [&](const glm::dvec3& from, const glm::dvec3& facet, double weight) {
        const glm::dvec3 mirrored = 2 * glm::dot(from, facet) * facet - from;
        if (mirrored.z > 0) kept += weight * masking(mirrored.z, facets);
    });
    return kept;
}

/// (1 - a/2) (1 - b/2) + R (a + b + a b (R - 1)), with a and b = (1 - cosine)^5 of both directions, and R = roughness
/// (1 + cosine between them). Its mean follows from those of a, a cosine and a cosine^2.
double burley_diffuse(double roughness) {
    constexpr double a = 1.0 / 21, once = 1.0 / 84, twice = 1.0 / 252;
    const double line = 1.0 / 9 - a * a - once * once,
                 square = a * a + 2 * once * once + twice * twice + (a - twice) * (a - twice) / 2;
    return (1 - a / 2) * (1 - a / 2) + roughness * line + roughness * roughness * square;
}

/// What enters, is reflected by the base, meets the border from inside and leaves, over what enters claray's base.
RoughBase::RoughBase(double ior, const Facets& facets, bool tinted) : tinted_(tinted) {
    const bool smooth = facets.alpha < 1e-3;
    if (smooth && ior <= 1) return;
    inner_ = smooth ? inner_reflectance(ior) : rough_border(1 / ior, facets).reflected;
    returned_ = 1 - inner_;
    if (smooth) return;
    const RoughBorder outer = rough_border(ior, facets);
    const double reflected = facets.beckmann ? rough_border(ior, shown(facets)).reflected : outer.reflected;
    returned_ = outer.passed * outer.passed / (ior * ior * (1 - reflected));
}

float RoughBase::albedo(float of_file) const {
    return float(std::clamp(of_file * returned_ / (1 - (tinted_ ? of_file : 1) * inner_), 0.0, 1.0));
}

}  // namespace claray
