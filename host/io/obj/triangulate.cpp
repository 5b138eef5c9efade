#include "host/io/obj/triangulate.hpp"

#include <cmath>

namespace claray {
namespace {

/// Twice the area vector of a polygon by Newell's method, about its first point: no cancellation far from the origin.
glm::dvec3 area_vector(std::span<const glm::vec3> points) {
    const glm::dvec3 origin(points[0]);
    glm::dvec3 sum(0.0);
    for (std::size_t i = 1; i + 1 < points.size(); ++i)
        sum += glm::cross(glm::dvec3(points[i]) - origin, glm::dvec3(points[i + 1]) - origin);
    return sum;
}

/// Drops the axis along which the polygon is seen largest, so that it runs counter-clockwise in the plane.
std::vector<glm::dvec2> project(std::span<const glm::vec3> points) {
    const glm::dvec3 area = area_vector(points), size = glm::abs(area);
    const int drop = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if (area[drop] < 0.0) std::swap(u, v);
    std::vector<glm::dvec2> flat;
    flat.reserve(points.size());
    for (const glm::vec3& p : points) flat.emplace_back(p[u], p[v]);
    return flat;
}

/// Twice the signed area of a triangle; positive where it is counter-clockwise.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// What is left of a polygon: a ring of corners, of which some were cut off.
class Ring {
public:
    explicit Ring(std::vector<glm::dvec2> points) : points_(std::move(points)), left_(std::uint32_t(points_.size())) {
        for (std::uint32_t i = 0; i < left_; ++i) {
            before_.push_back(i ? i - 1 : left_ - 1);
            after_.push_back(i + 1 < left_ ? i + 1 : 0);
        }
        for (std::uint32_t i = 0; i < left_; ++i)
            if (is_reflex(i)) reflex_.push_back(i);
    }

    [[nodiscard]] std::uint32_t left() const { return left_; }
    [[nodiscard]] std::uint32_t before(std::uint32_t i) const { return before_[i]; }
    [[nodiscard]] std::uint32_t after(std::uint32_t i) const { return after_[i]; }

    /// A corner can be cut off where it bends inwards and its triangle holds no other corner. Only reflex corners can
    /// lie inside.
    [[nodiscard]] bool is_ear(std::uint32_t i) const {
        const glm::dvec2 &a = points_[before_[i]], &b = points_[i], &c = points_[after_[i]];
        if (!(turn(a, b, c) > 0.0)) return false;
        for (const std::uint32_t other : reflex_) {
            if (other == before_[i] || other == i || other == after_[i]) continue;
            const glm::dvec2& p = points_[other];
            if (p == a || p == b || p == c) continue;  // polygons with holes touch themselves along a cut
            if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
        }
        return true;
    }

    void cut(std::uint32_t i) {
        after_[before_[i]] = after_[i];
        before_[after_[i]] = before_[i];
        --left_;
        // Cutting an ear never makes a corner reflex, but its neighbours may stop being so.
        std::erase_if(reflex_, [&](std::uint32_t other) {
            return other == i || ((other == before_[i] || other == after_[i]) && !is_reflex(other));
        });
    }

private:
    [[nodiscard]] bool is_reflex(std::uint32_t i) const {
        return !(turn(points_[before_[i]], points_[i], points_[after_[i]]) > 0.0);
    }

    std::vector<glm::dvec2> points_;
    std::vector<std::uint32_t> before_, after_, reflex_;
    std::uint32_t left_;
};

}  // namespace

void triangulate(std::span<const glm::vec3> points, std::vector<glm::uvec3>& triangles) {
    if (points.size() == 3) {
        triangles.emplace_back(0, 1, 2);
        return;
    }
    Ring ring(project(points));
    std::uint32_t corner = 0;
    std::uint32_t failures = 0;
    bool simple = true;
    while (ring.left() > 3) {
        // After a whole turn without an ear the polygon is not simple: cut it up in order.
        simple = simple && failures < ring.left();
        if (simple && !ring.is_ear(corner)) {
            corner = ring.after(corner);
            ++failures;
            continue;
        }
        triangles.emplace_back(ring.before(corner), corner, ring.after(corner));
        ring.cut(corner);
        // Going on after the next corner makes fewer slivers than a fan.
        corner = ring.after(ring.after(corner));
        failures = 0;
    }
    triangles.emplace_back(ring.before(corner), corner, ring.after(corner));
}

}  // namespace claray
