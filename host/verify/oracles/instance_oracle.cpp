#include "host/verify/oracles/instance_oracle.hpp"

#include <algorithm>
#include <cmath>

namespace claray::verify {
namespace {

constexpr double unit_roundoff = 0x1p-24;

/// x' = linear x + origin.
struct Placement {
    glm::dmat3 linear;
    glm::dvec3 origin;
};

Placement placement_of(const Instance& i) {
    Placement p;
    for (int k = 0; k < 3; ++k) p.linear[k] = {i.row0[k], i.row1[k], i.row2[k]};
    p.origin = {i.row0[3], i.row1[3], i.row2[3]};
    return p;
}

Placement placement_at(const Instance& begin, const Instance& end, double time) {
    const Placement a = placement_of(begin), b = placement_of(end);
    return {a.linear * (1 - time) + b.linear * time, a.origin * (1 - time) + b.origin * time};
}

/// A bound on how far rounding displaces a ray in the object, relative to its distance: |A| |A^-1|, by rows, times the
/// roundings of a product of matrix and vector and of what it consists of.
double relative_error(const glm::dmat3& a) {
    const glm::dmat3 inverse = glm::inverse(a);
    double worst = 0;
    for (int row = 0; row < 3; ++row) {
        double sum = 0;
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k) sum += std::fabs(a[k][row] * inverse[j][k]);
        worst = std::max(worst, sum);
    }
    return 8 * unit_roundoff * worst;
}

struct Crossing {
    double t = 0;         // distance to the triangle's plane
    double cosine = 0;    // of the angle to the normal, in size
    double distance = 0;  // in the plane, to the nearest edge; negative outside
};

Crossing cross_plane(const Ray& ray, const glm::dvec3* v) {
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    const glm::dvec3 n = glm::normalize(glm::cross(v[1] - v[0], v[2] - v[0]));
    Crossing crossing;
    crossing.t = glm::dot(n, v[0] - o) / glm::dot(n, d);
    crossing.cosine = std::fabs(glm::dot(n, d)) / glm::length(d);
    crossing.distance = 1e300;
    const glm::dvec3 p = o + crossing.t * d;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = v[(k + 1) % 3] - v[k];
        crossing.distance = std::min(crossing.distance, glm::dot(glm::cross(n, edge), p - v[k]) / glm::length(edge));
    }
    return crossing;
}

}  // namespace

std::vector<glm::dvec3> world_corners(std::span<const Mesh> bottoms, std::span<const Instance> instances) {
    return world_corners(bottoms, instances, instances, 0);
}

std::vector<glm::dvec3> world_corners(std::span<const Mesh> bottoms, std::span<const Instance> begins,
                                      std::span<const Instance> ends, double time) {
    std::vector<glm::dvec3> corners;
    for (std::size_t i = 0; i < begins.size(); ++i) {
        const Placement at = placement_at(begins[i], ends[i], time);
        const Mesh& mesh = bottoms[begins[i].bottom];
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) corners.push_back(at.linear * glm::dvec3(mesh.positions[t[k]]) + at.origin);
    }
    return corners;
}

InstanceOracle::InstanceOracle(std::span<const Mesh> bottoms, std::span<const Instance> instances)
    : InstanceOracle(bottoms, instances, instances, 0) {}

InstanceOracle::InstanceOracle(std::span<const Mesh> bottoms, std::span<const Instance> begins,
                               std::span<const Instance> ends, double time)
    : corners_(world_corners(bottoms, begins, ends, time)), oracle_(corners_) {
    for (std::size_t i = 0; i < begins.size(); ++i) {
        const Placement at = placement_at(begins[i], ends[i], time);
        first_.push_back(error_.size());
        error_.resize(error_.size() + bottoms[begins[i].bottom].triangles.size(), relative_error(at.linear));
        origins_.resize(error_.size(), at.origin);
    }
}

/// How far from the given ray, at t, the one that is traced in the object may be.
double InstanceOracle::tolerance(const Ray& ray, std::size_t triangle, double t) const {
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    return error_[triangle] * (glm::length(o - origins_[triangle]) + glm::length(t * d));
}

bool InstanceOracle::near_edge(const Ray& ray, std::size_t triangle) const {
    const Crossing crossing = cross_plane(ray, &corners_[3 * triangle]);
    return std::fabs(crossing.distance) * crossing.cosine <= tolerance(ray, triangle, crossing.t);
}

bool InstanceOracle::agrees(const Ray& ray, const InstanceHit& hit, const OracleHit& expected, bool& marginal) const {
    const bool found = hit.primitive != CLARAY_MISS, expects = expected.primitive != CLARAY_MISS;
    if (!found && !expects) return hit.instance == CLARAY_MISS && hit.t == ray.tmax;
    double t_error = 0;
    if (found) {
        const std::size_t triangle = first_.at(hit.instance) + hit.primitive;
        const Crossing crossing = cross_plane(ray, &corners_.at(3 * triangle));
        const double allowed = tolerance(ray, triangle, crossing.t);
        const double speed = glm::length(glm::dvec3(ray.dx, ray.dy, ray.dz)) * crossing.cosine;
        t_error = allowed / speed + unit_roundoff * std::fabs(crossing.t);
        const bool genuine =
            std::fabs(hit.t - crossing.t) <= t_error && crossing.distance * crossing.cosine >= -allowed;
        if (!genuine) return false;
        if (triangle == expected.primitive) return true;
    }
    marginal = true;
    // Another triangle, or none: correct if the oracle's is as near, or if its edge is.
    if (expects && found && std::fabs(hit.t - expected.t) <= 2 * t_error) return true;
    if (expects && (!found || expected.t < hit.t)) return near_edge(ray, expected.primitive);
    return near_edge(ray, first_[hit.instance] + hit.primitive);
}

InstanceComparison InstanceOracle::compare(std::span<const Ray> rays, std::span<const InstanceHit> hits) const {
    const std::vector<OracleHit> expected = oracle_.closest_hits(rays);
    InstanceComparison result;
    result.rays = rays.size();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        bool marginal = false;
        result.hits += expected[i].primitive != CLARAY_MISS;
        if (!agrees(rays[i], hits[i], expected[i], marginal) && result.wrong++ == 0) result.first_wrong = i;
        result.marginal += marginal;
    }
    return result;
}

}  // namespace claray::verify
