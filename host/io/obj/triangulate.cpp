#include "host/io/obj/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

struct Triangle {
    glm::dvec2 corners[3];  ///< counter-clockwise
    glm::dvec2 lo, hi;      ///< its box

    Triangle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c)
        : corners{a, b, c}, lo(glm::min(a, glm::min(b, c))), hi(glm::max(a, glm::max(b, c))) {}

    [[nodiscard]] bool holds(const glm::dvec2& p) const {
        return turn(corners[0], corners[1], p) >= 0.0 && turn(corners[1], corners[2], p) >= 0.0 &&
               turn(corners[2], corners[0], p) >= 0.0;
    }
};

struct Box {
    glm::dvec2 lo, hi;

    /// True where all of the box is beside the triangle's or behind an edge, as `turn` rounds.
    [[nodiscard]] bool misses(const Triangle& triangle) const {
        if (triangle.hi.x < lo.x || triangle.lo.x > hi.x || triangle.hi.y < lo.y || triangle.lo.y > hi.y) return true;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec2 &a = triangle.corners[k], &b = triangle.corners[(k + 1) % 3];
            if (turn(a, b, {b.y > a.y ? lo.x : hi.x, b.x > a.x ? hi.y : lo.y}) < 0.0) return true;
        }
        return false;
    }
};

/// Points that can be taken away: a balanced tree over them (Bentley 1975, "Multidimensional binary search trees"),
/// whose nodes have a box and count the points that are left.
class PointTree {
public:
    PointTree(const std::vector<glm::dvec2>& points, std::vector<std::uint32_t> members)
        : points_(points), members_(std::move(members)), nodes_(members_.size()) {
        if (members_.empty()) return;
        place_.resize(points.size());
        build(0, members_.size(), 0);
    }

    void take_away(std::uint32_t point) {
        std::size_t begin = 0, end = members_.size();
        for (const std::size_t at = place_[point]; end > begin;) {
            const std::size_t middle = (begin + end) / 2;
            --nodes_[middle].left;
            if (at == middle) return;
            at < middle ? end = middle : begin = middle + 1;
        }
    }

    /// Whether `test` is true of a point in a triangle. Some that are taken away are tried, too.
    template <class Test>
    [[nodiscard]] bool any(const Triangle& triangle, const Test& test) {
        return any(0, members_.size(), triangle, test);
    }
    [[nodiscard]] std::size_t looks() const { return looks_; }

private:
    struct Node {
        Box box;
        std::size_t left = 0;
    };

    void build(std::size_t begin, std::size_t end, int axis) {
        if (begin == end) return;
        const std::size_t middle = (begin + end) / 2;
        const auto at = [&](std::size_t i) { return members_.begin() + std::ptrdiff_t(i); };
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
            return points_[a][axis] < points_[b][axis] || (points_[a][axis] == points_[b][axis] && a < b);
        });
        Node& node = nodes_[middle];
        node = {{points_[members_[middle]], points_[members_[middle]]}, end - begin};
        for (std::size_t i = begin; i < end; ++i) {
            node.box.lo = glm::min(node.box.lo, points_[members_[i]]);
            node.box.hi = glm::max(node.box.hi, points_[members_[i]]);
        }
        place_[members_[middle]] = middle;
        build(begin, middle, 1 - axis), build(middle + 1, end, 1 - axis);
    }

    template <class Test>
    [[nodiscard]] bool any(std::size_t begin, std::size_t end, const Triangle& triangle, const Test& test) {
        if (begin == end) return false;
        ++looks_;
        const std::size_t middle = (begin + end) / 2;
        const Node& node = nodes_[middle];
        if (node.left == 0 || node.box.misses(triangle)) return false;
        const std::uint32_t member = members_[middle];
        return (triangle.holds(points_[member]) && test(member)) || any(begin, middle, triangle, test) ||
               any(middle + 1, end, triangle, test);
    }

    const std::vector<glm::dvec2>& points_;
    std::vector<std::uint32_t> members_;  ///< each range's middle parts it
    std::vector<Node> nodes_;             ///< of the range with this middle
    std::vector<std::size_t> place_;      ///< of points among the members
    std::size_t looks_ = 0;               ///< at nodes
};

/// What is left of a polygon: a ring of corners, of which some were cut off.
class Ring {
public:
    explicit Ring(std::vector<glm::dvec2> points)
        : points_(std::move(points)),
          left_(std::uint32_t(points_.size())),
          before_(left_),
          after_(left_),
          reflex_(left_),
          tree_(points_, reflex_corners()) {}

    [[nodiscard]] std::uint32_t left() const { return left_; }
    [[nodiscard]] std::size_t looks() const { return looks_ + tree_.looks(); }
    [[nodiscard]] std::uint32_t before(std::uint32_t i) const { return before_[i]; }
    [[nodiscard]] std::uint32_t after(std::uint32_t i) const { return after_[i]; }
    [[nodiscard]] bool is_cut(std::uint32_t i) const { return after_[before_[i]] != i; }

    /// A corner can be cut off where it bends inwards and its triangle holds no other corner. Only reflex corners can
    /// lie inside.
    [[nodiscard]] bool is_ear(std::uint32_t i) {
        ++looks_;
        const glm::dvec2 &a = points_[before_[i]], &b = points_[i], &c = points_[after_[i]];
        if (!(turn(a, b, c) > 0.0)) return false;
        return !tree_.any({a, b, c}, [&](std::uint32_t other) {
            const bool is_corner = other == before_[i] || other == i || other == after_[i];
            const glm::dvec2& p = points_[other];
            // Polygons with holes touch themselves along a cut.
            return reflex_[other] && !is_corner && p != a && p != b && p != c;
        });
    }

    void cut(std::uint32_t i) {
        after_[before_[i]] = after_[i];
        before_[after_[i]] = before_[i];
        --left_;
        // Cutting an ear never makes a corner reflex, but its neighbours may stop being so.
        forget(i);
        for (const std::uint32_t neighbour : {before_[i], after_[i]})
            if (!bends_outwards(neighbour)) forget(neighbour);
    }

private:
    [[nodiscard]] std::vector<std::uint32_t> reflex_corners() {
        for (std::uint32_t i = 0; i < left_; ++i) {
            before_[i] = i ? i - 1 : left_ - 1;
            after_[i] = i + 1 < left_ ? i + 1 : 0;
        }
        std::vector<std::uint32_t> found;
        for (std::uint32_t i = 0; i < left_; ++i) {
            reflex_[i] = bends_outwards(i);
            const bool is_number = !std::isnan(points_[i].x) && !std::isnan(points_[i].y);
            if (reflex_[i] && is_number) found.push_back(i);
            reflex_[i] = reflex_[i] && is_number;
        }
        return found;
    }

    [[nodiscard]] bool bends_outwards(std::uint32_t i) const {
        return !(turn(points_[before_[i]], points_[i], points_[after_[i]]) > 0.0);
    }

    void forget(std::uint32_t i) {
        if (!reflex_[i]) return;
        reflex_[i] = false;
        tree_.take_away(i);
    }

    std::vector<glm::dvec2> points_;
    std::uint32_t left_;
    std::vector<std::uint32_t> before_, after_;
    std::vector<bool> reflex_;
    PointTree tree_;  ///< of the reflex corners
    std::size_t looks_ = 0;
};

void cut(Ring& ring, std::uint32_t corner, std::vector<glm::uvec3>& triangles) {
    triangles.emplace_back(ring.before(corner), corner, ring.after(corner));
    ring.cut(corner);
}

/// Cuts off ears until three corners are left or there is no ear. Where an ear was cut off, its neighbours are asked
/// next; and all corners are only where none of these was an ear, so that each is asked a few times.
void cut_ears(Ring& ring, std::uint32_t corners, std::vector<glm::uvec3>& triangles) {
    std::vector<std::uint32_t> asked(corners), changed, last_round(corners, 0);
    for (std::uint32_t i = 0; i < corners; ++i) asked[i] = i;
    std::uint32_t round = 0;
    const auto ask = [&](std::uint32_t corner) {
        if (std::exchange(last_round[corner], round) != round) changed.push_back(corner);
    };
    for (bool all = true; ring.left() > 3;) {
        changed.clear();
        ++round;
        bool skips = false, any = false;
        for (const std::uint32_t corner : asked) {
            if (ring.left() <= 3) return;
            if (ring.is_cut(corner)) continue;
            // Leaving out the next corner makes fewer slivers than a fan.
            if (std::exchange(skips, false)) {
                ask(corner);
            } else if (ring.is_ear(corner)) {
                ask(ring.before(corner)), ask(ring.after(corner));
                cut(ring, corner, triangles);
                skips = any = true;
            }
        }
        if (!any && all) return;
        all = changed.empty();
        asked.swap(changed);
        if (all)
            for (std::uint32_t i = 0; i < corners; ++i)
                if (!ring.is_cut(i)) asked.push_back(i);
    }
}

}  // namespace

std::size_t triangulate(std::span<const glm::vec3> points, std::vector<glm::uvec3>& triangles) {
    if (points.size() == 3) {
        triangles.emplace_back(0, 1, 2);
        return 0;
    }
    const auto corners = std::uint32_t(points.size());
    Ring ring(project(points));
    constexpr std::uint32_t many = 256;  // of which each is asked until the whole ring holds no ear
    if (corners > many) cut_ears(ring, corners, triangles);
    std::uint32_t corner = 0;
    while (ring.is_cut(corner)) ++corner;
    std::uint32_t failures = 0;
    bool simple = corners <= many;
    while (ring.left() > 3) {
        // After a whole turn without an ear the polygon is not simple: cut it up in order.
        simple = simple && failures < ring.left();
        if (simple && !ring.is_ear(corner)) {
            corner = ring.after(corner);
            ++failures;
            continue;
        }
        const std::uint32_t next = ring.after(ring.after(corner));
        cut(ring, corner, triangles);
        corner = next;  // not the next one, which makes fewer slivers than a fan
        failures = 0;
    }
    triangles.emplace_back(ring.before(corner), corner, ring.after(corner));
    return ring.looks();
}

}  // namespace claray
