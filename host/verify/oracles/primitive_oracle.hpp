// The oracle of primitives: every one, in 80-bit arithmetic; curves by many samples of the exact curve.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "claray/primitives/curves.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {

using LongVector = glm::vec<3, long double>;

/// Distances at which a ray crosses a primitive's surface, in 80-bit arithmetic.
using Crossings = std::vector<long double> (*)(const float* data, const LongVector& origin,
                                               const LongVector& direction);

struct ExactKind {
    const char* name;
    PrimitiveKind kind;
    Crossings crossings;
};
/// Spheres, discs and cylinders.
[[nodiscard]] std::vector<ExactKind> exact_kinds();
[[nodiscard]] std::vector<float> random_data(const ExactKind& of, std::size_t count, float size, std::uint64_t seed);
/// Tests every primitive. The distance of a miss is infinite.
[[nodiscard]] OracleHit closest_primitive(const ExactKind& of, const std::vector<float>& data, const Ray& ray);

/// The exact curve in float64: a place and a radius at each parameter.
struct ExactCurve {
    glm::dvec4 p[4];  // Bezier control points

    ExactCurve(const glm::vec4* c, CurveBasis basis) {
        const glm::dvec4 a(c[0]), b(c[1]), d(c[2]), e(c[3]);
        if (basis == CurveBasis::bezier)
            p[0] = a, p[1] = b, p[2] = d, p[3] = e;
        else
            p[0] = (a + 4. * b + d) / 6., p[1] = (2. * b + d) / 3., p[2] = (b + 2. * d) / 3.,
            p[3] = (b + 4. * d + e) / 6.;
    }
    [[nodiscard]] glm::dvec4 at(double s) const {
        const double r = 1 - s;
        return r * r * r * p[0] + 3 * r * r * s * p[1] + 3 * r * s * s * p[2] + s * s * s * p[3];
    }
};

struct Tufts {
    std::vector<glm::vec4> points;
    std::vector<std::uint32_t> segments;
};

/// Strands of `length` segments with a radius that varies between a fifth of `thickness` and all of it.
[[nodiscard]] Tufts random_strands(std::size_t count, std::uint32_t length, CurveBasis basis, std::uint64_t seed,
                                   float thickness = 0.02f);
[[nodiscard]] std::vector<ExactCurve> exact_curves(const Tufts& tufts, CurveBasis basis);
/// Where a ray meets the first curve: from `early` on, if all were thicker by a tolerance, and up to `late`, if all
/// were thinner; infinite if it meets none.
struct Contact {
    double early = std::numeric_limits<double>::infinity(), late = early;
};
[[nodiscard]] Contact first_contact(const std::vector<ExactCurve>& curves, const Ray& ray, double tolerance,
                                    CurveShape shape);

}  // namespace claray::verify
