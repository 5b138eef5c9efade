#include "host/verify/oracles/nearest_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace claray::verify {
namespace {

struct V {
    long double x, y, z;
};
V operator-(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
V operator+(V a, V b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
V operator*(long double s, V a) { return {s * a.x, s * a.y, s * a.z}; }
long double dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
V cross(V a, V b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
long double length(V a) { return std::sqrt(dot(a, a)); }
V to(const glm::vec3& p) { return {p.x, p.y, p.z}; }

/// From the origin to a segment.
long double to_segment(V a, V b) {
    const V e = b - a;
    const long double t = -dot(a, e) / dot(e, e);
    return length(t <= 0 ? a : t >= 1 ? b : a + t * e);
}

constexpr long double infinite = std::numeric_limits<long double>::infinity();
/// Half an ulp of the float that is nearest, and a little.
long double rounding(long double distance) {
    const float rounded = std::min(float(distance), std::numeric_limits<float>::max());
    return 0.5001L * ((long double)(std::nextafter(rounded, std::numeric_limits<float>::infinity())) - rounded);
}

}  // namespace

long double NearestOracle::distance(const glm::vec3& point, std::size_t i) const {
    const glm::uvec3 t = mesh_.triangles[i];
    const V p = to(point), a = to(mesh_.positions[t.x]) - p, b = to(mesh_.positions[t.y]) - p,
            c = to(mesh_.positions[t.z]) - p;
    if (!std::isfinite(dot(a, a) + dot(b, b) + dot(c, c))) return infinite;
    if (length(b - a) == 0 || length(c - b) == 0 || length(a - c) == 0) return infinite;
    const long double edges = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
    const V n = cross(b - a, c - a);
    const bool inside = dot(cross(n, b - a), a) < 0 && dot(cross(n, c - b), b) < 0 && dot(cross(n, a - c), c) < 0;
    return inside ? std::min(edges, std::fabs(dot(n, a)) / length(n)) : edges;
}

long double NearestOracle::error(const glm::vec3& point, std::size_t i) const {
    const glm::uvec3 t = mesh_.triangles[i];
    const V p = to(point);
    return 0x1p-50L * std::max({length(to(mesh_.positions[t.x]) - p), length(to(mesh_.positions[t.y]) - p),
                                length(to(mesh_.positions[t.z]) - p)});
}

const char* NearestOracle::judge(const glm::vec3& point, const NearestPoint& answer, float reach) const {
    long double least = infinite, error_of_least = 0;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
        const long double d = distance(point, i);
        if (d < least) least = d, error_of_least = error(point, i);
    }
    if (answer.primitive == CLARAY_MISS)
        return answer.distance != reach                           ? "distance of a miss"
               : least > reach - rounding(reach) - error_of_least ? ""
                                                                  : "missed";
    const long double d = answer.distance, own = distance(point, answer.primitive);
    const long double slack = error(point, answer.primitive) + rounding(d);
    if (!(std::fabs(d - own) <= slack)) return "distance";
    if (!(d <= reach)) return "out of reach";
    if (!(d <= least + error_of_least + rounding(least))) return "not nearest";
    for (std::size_t i = 0; i < answer.primitive; ++i) {
        const long double other = distance(point, i);
        if (float(other + error(point, i)) <= answer.distance) return "a lower triangle is as near";
    }
    const glm::uvec3 t = mesh_.triangles[answer.primitive];
    const V a = to(mesh_.positions[t.x]), b = to(mesh_.positions[t.y]), c = to(mesh_.positions[t.z]);
    const long double u = answer.u, v = answer.v;
    const V foot = (1 - u - v) * a + u * b + v * c, found = {answer.x, answer.y, answer.z};
    const long double size = std::max({length(a), length(b), length(c)});
    if (length(foot - found) > 0x1p-21L * size) return "point and weights";
    if (std::fabs(length(found - to(point)) - d) > 0x1p-21L * size + 2 * rounding(d)) return "point and distance";
    return "";
}

/// Clips the triangle by the box's planes (Sutherland and Hodgman 1974): something is left if they overlap.
bool overlaps(const Mesh& mesh, std::size_t i, const Bounds& box) {
    using Corner = std::array<long double, 3>;
    std::vector<Corner> polygon;
    for (int k = 0; k < 3; ++k) {
        const glm::vec3 p = mesh.positions[mesh.triangles[i][k]];
        polygon.push_back({p.x, p.y, p.z});
    }
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const long double sign = side % 2 == 0 ? 1 : -1, plane = side % 2 == 0 ? box.lo[axis] : box.hi[axis];
        std::vector<Corner> kept;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Corner p = polygon[k], q = polygon[(k + 1) % polygon.size()];
            const long double from = sign * (p[axis] - plane), to = sign * (q[axis] - plane);
            if (from >= 0) kept.push_back(p);
            if ((from > 0 && to < 0) || (from < 0 && to > 0)) {
                Corner cut;
                for (int j = 0; j < 3; ++j) cut[j] = p[j] + (q[j] - p[j]) * (from / (from - to));
                cut[axis] = plane;
                kept.push_back(cut);
            }
        }
        polygon = kept;
    }
    return !polygon.empty();
}

}  // namespace claray::verify
