#include "bench/peers/curve_differences.hpp"

#include <cmath>
#include <limits>

namespace claray::measure {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double tolerance = 1. / 32;  // of a segment's largest radius, between its pieces and the exact curve

/// A segment as Bezier control points, and a ball around them.
struct Segment {
    glm::dvec4 p[4];
    glm::dvec4 around;
    double thickest;
    bool first, last;  // of its strand
};

std::vector<Segment> segments_of(const Strands& strands) {
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < strands.segments.size(); ++i) {
        const std::uint32_t at = strands.segments[i];
        const glm::dvec4 a(strands.points[at]), b(strands.points[at + 1]), c(strands.points[at + 2]),
            d(strands.points[at + 3]);
        Segment s{{(a + 4. * b + c) / 6., (2. * b + c) / 3., (b + 2. * c) / 3., (b + 4. * c + d) / 6.}, {}, {}, {}, {}};
        s.thickest = std::max(std::max(s.p[0].w, s.p[1].w), std::max(s.p[2].w, s.p[3].w));
        s.around = 0.5 * (s.p[0] + s.p[3]), s.around.w = 0;
        for (const glm::dvec4& p : s.p)
            s.around.w = std::max(s.around.w, glm::length(glm::dvec3(p - s.around)) + (1 + tolerance) * s.thickest);
        s.first = i == 0 || strands.segments[i - 1] + 1 != at;
        s.last = i + 1 == strands.segments.size() || strands.segments[i + 1] != at + 1;
        segments.push_back(s);
    }
    return segments;
}

/// What a ray meets of the balls along all curves, with radii that grow by a part of the largest.
struct Contact {
    double t = infinity;
    bool at_end = false;  // by the ball at the end of a strand
    bool inside = false;  // the ray begins in a ball
};

void meet(const Segment& segment, const Ray& ray, double grow, Contact& contact) {
    constexpr int steps = 400;  // balls so close that the hull between two is nowhere a 1000th of a radius farther out
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    const double dd = glm::dot(d, d);
    for (int i = 0; i <= steps; ++i) {
        const double s = double(i) / steps, r = 1 - s;
        const glm::dvec4 c = r * r * r * segment.p[0] + 3 * r * r * s * segment.p[1] + 3 * r * s * s * segment.p[2] +
                             s * s * s * segment.p[3];
        const glm::dvec3 to = glm::dvec3(c) - o;
        const double along = glm::dot(to, d) / dd, radius = c.w + grow * segment.thickest;
        const double in2 = radius * radius - glm::dot(to - along * d, to - along * d);
        contact.inside |= glm::dot(to, to) <= radius * radius;
        if (!(in2 >= 0) || radius < 0) continue;
        const double t = along - std::sqrt(in2 / dd);
        if (t <= ray.tmin || t >= contact.t) continue;
        contact.t = t, contact.at_end = (i == 0 && segment.first) || (i == steps && segment.last);
    }
}

Contact first_contact(const std::vector<Segment>& segments, const Ray& ray, double grow) {
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d = glm::normalize(glm::dvec3(ray.dx, ray.dy, ray.dz));
    Contact contact;
    for (const Segment& segment : segments) {
        const glm::dvec3 to = glm::dvec3(segment.around) - o;
        const double along = std::max(glm::dot(to, d), 0.), reach = segment.around.w;
        if (glm::dot(to - along * d, to - along * d) <= reach * reach) meet(segment, ray, grow, contact);
    }
    return contact;
}

void judge(float exact, float claray, float embree, Right& right) {
    const bool mine = !differ(claray, exact), theirs = !differ(embree, exact);
    ++(mine && theirs ? right.both : mine ? right.claray : theirs ? right.embree : right.neither);
}

void classify(const std::vector<Segment>& segments, const Ray& ray, float claray, float embree, Differences& found) {
    const Contact exact = first_contact(segments, ray, 0);
    if (exact.inside) return void(++found.begin_inside);
    if (exact.at_end) return void(++found.at_ends);
    const double early = first_contact(segments, ray, tolerance).t, late = first_contact(segments, ray, -tolerance).t;
    const auto between = [&](float t) { return t >= early && t <= late; };
    if (std::isfinite(late) && between(claray) && between(embree)) return void(++found.near);
    judge(float(exact.t), claray, embree, differ(float(early), float(late)) ? found.graze : found.others);
}

}  // namespace

bool differ(float a, float b) {
    return std::isfinite(a) != std::isfinite(b) || (std::isfinite(a) && std::fabs(a - b) > 1e-3f * a);
}

Differences explain(const Strands& strands, std::span<const Ray> rays, std::span<const float> claray,
                    std::span<const float> embree) {
    const std::vector<Segment> segments = segments_of(strands);
    Differences found;
    for (std::size_t i = 0; i < rays.size(); ++i) classify(segments, rays[i], claray[i], embree[i], found);
    return found;
}

}  // namespace claray::measure
