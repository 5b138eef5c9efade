#include "host/io/world/rough.hpp"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "host/io/world/spectrum.hpp"

namespace claray {
namespace {

/// Smith's masking of GGX.
double masking(double cosine, double alpha) {
    const double c = std::abs(cosine), tangent2 = (1 - c * c) / std::max(c * c, 1e-12);
    return 2 / (1 + std::sqrt(1 + alpha * alpha * tangent2));
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

/// Sums weigh(from, facet), over directions of diffuse light and the facets that these see.
template <class Weigh>
void for_each_facet(double alpha, const Weigh& weigh) {
    constexpr int angles = 32, side = 24;
    for (int i = 0; i < angles; ++i) {
        const double cosine = std::sqrt((i + 0.5) / angles);  // equal shares of diffuse light
        const glm::dvec3 from(std::sqrt(1 - cosine * cosine), 0, cosine);
        for (int k = 0; k < side * side; ++k)
            weigh(from, visible_facet(from, alpha, (k % side + 0.5) / side, (k / side + 0.5) / side),
                  1.0 / (angles * side * side));
    }
}

}  // namespace

RoughBorder rough_border(double ior, double alpha) {
    RoughBorder border{0, 0};
    for_each_facet(alpha, [&](const glm::dvec3& from, const glm::dvec3& facet, double weight) {
        const double cosine = glm::dot(from, facet);
        if (cosine <= 0) return;
        const double sine2 = (1 - cosine * cosine) / (ior * ior),
                     reflectance = sine2 >= 1 ? 1 : conductor_reflectance(ior, 0, cosine);
        const glm::dvec3 mirrored = 2 * cosine * facet - from;
        if (mirrored.z > 0) border.reflected += weight * reflectance * masking(mirrored.z, alpha);
        if (sine2 >= 1) return;
        const glm::dvec3 refracted = (cosine / ior - std::sqrt(1 - sine2)) * facet - from / ior;
        if (refracted.z < 0) border.passed += weight * (1 - reflectance) * masking(refracted.z, alpha);
    });
    return border;
}

double kept_by_facets(double alpha) {
    double kept = 0;
    for_each_facet(alpha, [&](const glm::dvec3& from, const glm::dvec3& facet, double weight) {
        const glm::dvec3 mirrored = 2 * glm::dot(from, facet) * facet - from;
        if (mirrored.z > 0) kept += weight * masking(mirrored.z, alpha);
    });
    return kept;
}

/// What enters, is reflected by the base, meets the border from inside and leaves, over what enters claray's base.
RoughBase::RoughBase(double ior, double alpha, bool tinted) : tinted_(tinted) {
    const bool smooth = alpha < 1e-3;
    if (smooth && ior <= 1) return;
    inner_ = smooth ? inner_reflectance(ior) : rough_border(1 / ior, alpha).reflected;
    returned_ = 1 - inner_;
    if (smooth) return;
    const RoughBorder outer = rough_border(ior, alpha);
    returned_ = outer.passed * outer.passed / (ior * ior * (1 - outer.reflected));
}

float RoughBase::albedo(float of_file) const {
    return float(std::clamp(of_file * returned_ / (1 - (tinted_ ? of_file : 1) * inner_), 0.0, 1.0));
}

}  // namespace claray
