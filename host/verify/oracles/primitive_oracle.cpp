#include "host/verify/oracles/primitive_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace claray::verify {
namespace {

/// The solutions of |p + t q|^2 = r^2.
std::vector<long double> circle(const LongVector& p, const LongVector& q, long double r) {
    const long double a = dot(q, q), b = dot(p, q), disc = b * b - a * (dot(p, p) - r * r);
    if (!(disc >= 0) || a == 0) return {};
    return {(-b - std::sqrt(disc)) / a, (-b + std::sqrt(disc)) / a};
}

std::vector<long double> cross_sphere(const float* s, const LongVector& o, const LongVector& d) {
    return circle(o - LongVector(s[0], s[1], s[2]), d, s[3]);
}

std::vector<long double> cross_disc(const float* s, const LongVector& o, const LongVector& d) {
    const LongVector n(s[4], s[5], s[6]), c(s[0], s[1], s[2]);
    const long double t = dot(n, c - o) / dot(n, d), r = length(o + t * d - c);
    return r <= s[3] && r >= s[7] ? std::vector<long double>{t} : std::vector<long double>{};
}

std::vector<long double> cross_cylinder(const float* s, const LongVector& o, const LongVector& d) {
    const LongVector a(s[0], s[1], s[2]), b(s[4], s[5], s[6]), axis = normalize(b - a), from = o - a;
    const auto across = [&](const LongVector& v) { return v - dot(v, axis) * axis; };
    std::vector<long double> found;
    for (const long double t : circle(across(from), across(d), s[3])) {
        const long double along = dot(from + t * d, axis);
        if (along >= 0 && along <= length(b - a)) found.push_back(t);
    }
    if (s[7] != 0)
        for (const LongVector& end : {a, b}) {
            const long double t = dot(end - o, axis) / dot(d, axis);
            if (length(o + t * d - end) <= s[3]) found.push_back(t);
        }
    return found;
}

}  // namespace

std::vector<ExactKind> exact_kinds() {
    return {{"spheres", sphere_kind(), cross_sphere},
            {"discs", disc_kind(), cross_disc},
            {"cylinders", cylinder_kind(), cross_cylinder}};
}

std::vector<float> random_data(const ExactKind& of, std::size_t count, float size, std::uint64_t seed) {
    Random random(seed);
    std::vector<float> data;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 a = random.in_cube(1), b = random.in_cube(1);
        data.insert(data.end(), {a.x, a.y, a.z, size * random.uniform(0.2f, 1.f)});
        if (of.kind.floats != 8) continue;
        const glm::vec3 second = of.crossings == cross_disc ? b : a + size * 3.f * b;
        const float last = of.crossings == cross_disc ? 0.1f * size * float(i % 2) : float(i % 2);
        data.insert(data.end(), {second.x, second.y, second.z, last});
    }
    return data;
}

OracleHit closest_primitive(const ExactKind& of, const std::vector<float>& data, const Ray& ray) {
    const LongVector o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    long double nearest = std::numeric_limits<long double>::infinity();
    std::uint32_t primitive = CLARAY_MISS;
    for (std::size_t p = 0; p < data.size() / of.kind.floats; ++p)
        for (const long double t : of.crossings(&data[p * of.kind.floats], o, d))
            if (float(t) > ray.tmin && float(t) <= ray.tmax && t < nearest) nearest = t, primitive = std::uint32_t(p);
    return {double(nearest), primitive};
}

Tufts random_strands(std::size_t count, std::uint32_t length, CurveBasis basis, std::uint64_t seed, float thickness) {
    Random random(seed);
    Tufts tufts;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t step = basis == CurveBasis::bezier ? 3 : 1;
        glm::vec3 at = random.in_cube(1), along = 0.1f * random.in_cube(1);
        for (std::uint32_t k = 0; k < length; ++k)
            tufts.segments.push_back(std::uint32_t(tufts.points.size()) + step * k);
        for (std::uint32_t k = 0; k < step * (length - 1) + 4; ++k) {
            tufts.points.emplace_back(at, thickness * random.uniform(0.2f, 1.f));
            along += 0.05f * random.in_cube(1), at += along;
        }
    }
    return tufts;
}

namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// Where a ray passes a point of a curve's centre line.
struct Passing {
    double t, off2, radius;  ///< place along the ray, squared distance from it, and the curve's radius there
    [[nodiscard]] bool within(double more) const { return off2 <= (radius + more) * (radius + more); }
};

Passing passing(const glm::dvec4& at, const glm::dvec3& o, const glm::dvec3& d) {
    const glm::dvec3 p = glm::dvec3(at) - o;
    const double t = dot(p, d) / dot(d, d);
    return {t, dot(p - t * d, p - t * d), at.w};
}

bool may_pass(const ExactCurve& curve, const glm::dvec3& o, const glm::dvec3& d, double more) {
    glm::dvec3 lo(1e9), hi(-1e9);  // of the control points: most rays pass far off
    double r = 0;
    for (const glm::dvec4& p : curve.p)
        lo = glm::min(lo, glm::dvec3(p)), hi = glm::max(hi, glm::dvec3(p)), r = std::max(r, p.w);
    const glm::dvec3 mid = 0.5 * (lo + hi) - o;
    const double along = dot(mid, d) / dot(d, d);
    return length(mid - along * d) <= 0.5 * length(hi - lo) + r + more;
}

/// The ray enters a round curve.
void meet_tube(const std::vector<Passing>& samples, double dd, double tolerance, Contact* first) {
    const auto entered = [&](const Passing& at, double more) {
        const double r = at.radius + more;
        return at.within(more) ? at.t - std::sqrt((r * r - at.off2) / dd) : no_limit;
    };
    for (const Passing& at : samples) {
        first->early = std::min(first->early, entered(at, tolerance));
        first->late = std::min(first->late, entered(at, -tolerance));
    }
}

/// The ray passes a flat curve's centre line somewhere in a stretch of it that is within the radius.
void meet_ribbon(const std::vector<Passing>& samples, double tolerance, Contact* first) {
    double last = -no_limit;
    bool met = false;
    const auto end_stretch = [&] {
        if (met) first->late = std::min(first->late, last);
        last = -no_limit, met = false;
    };
    for (const Passing& at : samples) {
        if (!at.within(tolerance)) {
            end_stretch();
            continue;
        }
        first->early = std::min(first->early, at.t);
        last = std::max(last, at.t), met |= at.within(-tolerance);
    }
    end_stretch();
}

}  // namespace

Contact first_contact(const std::vector<ExactCurve>& curves, const Ray& ray, double tolerance, CurveShape shape) {
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    constexpr int steps = 300;
    Contact first;
    std::vector<Passing> samples(steps + 1);
    for (const ExactCurve& curve : curves) {
        if (!may_pass(curve, o, d, tolerance)) continue;
        for (int i = 0; i <= steps; ++i) samples[std::size_t(i)] = passing(curve.at(double(i) / steps), o, d);
        if (shape == CurveShape::round)
            meet_tube(samples, dot(d, d), tolerance, &first);
        else
            meet_ribbon(samples, tolerance, &first);
    }
    return first;
}

std::vector<ExactCurve> exact_curves(const Tufts& tufts, CurveBasis basis) {
    std::vector<ExactCurve> curves;
    for (const std::uint32_t first : tufts.segments) curves.emplace_back(&tufts.points[first], basis);
    return curves;
}

}  // namespace claray::verify
