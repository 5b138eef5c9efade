#include "host/accuracy/studies/trees/cells.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace claray {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

struct Cell {
    glm::vec3 lo{infinite}, hi{-infinite};
    [[nodiscard]] bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
    [[nodiscard]] double area() const {
        const glm::dvec3 e(hi - lo);
        return e.x * e.y + e.y * e.z + e.z * e.x;
    }
};

Cell common_part(const Cell& a, const Cell& b) { return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)}; }

/// A triangle, and a box around its part in a cell.
struct Part {
    std::uint32_t triangle;
    Cell box;
};

std::array<glm::vec3, 3> corners_of(const LeafTriangle& t) {
    return {glm::vec3(t.v0x, t.v0y, t.v0z), glm::vec3(t.v1x, t.v1y, t.v1z), glm::vec3(t.v2x, t.v2y, t.v2z)};
}

/// Cuts off what is below `plane` on an axis, or with sign -1 above it (Sutherland and Hodgman 1974).
std::vector<glm::dvec3> cut(const std::vector<glm::dvec3>& polygon, int axis, double plane, double sign) {
    std::vector<glm::dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double from = (a[axis] - plane) * sign, to = (b[axis] - plane) * sign;
        if (from >= 0) kept.push_back(a);
        if ((from < 0) != (to < 0)) kept.push_back(a + from / (from - to) * (b - a));
    }
    return kept;
}

/// A box around the part of a triangle in a cell, empty if there is none. Roundings are far below the margin by which
/// both are enlarged, so that every point of the triangle is in the box of a cell that holds it.
Cell part_in(const LeafTriangle& triangle, const Cell& cell) {
    glm::vec3 size = glm::max(glm::abs(cell.lo), glm::abs(cell.hi));
    std::vector<glm::dvec3> polygon;
    for (const glm::vec3& corner : corners_of(triangle)) {
        size = glm::max(size, glm::abs(corner));
        polygon.emplace_back(corner);
    }
    const double margin = 1e-12 * double(std::max({size.x, size.y, size.z}));
    for (int axis = 0; axis < 3; ++axis) {
        polygon = cut(polygon, axis, double(cell.lo[axis]) - margin, 1);
        polygon = cut(polygon, axis, double(cell.hi[axis]) + margin, -1);
    }
    Cell box;
    for (const glm::dvec3& p : polygon)
        for (int axis = 0; axis < 3; ++axis) {
            box.lo[axis] = std::min(box.lo[axis], std::nextafter(float(p[axis] - margin), -infinite));
            box.hi[axis] = std::max(box.hi[axis], std::nextafter(float(p[axis] + margin), infinite));
        }
    return common_part(box, cell);
}

/// The parts that reach `cell`, a part of the cell of `parts`. Boxes that it cuts are made anew.
std::vector<Part> parts_in(std::span<const LeafTriangle> triangles, const std::vector<Part>& parts, const Cell& cell) {
    std::vector<Part> found;
    for (const Part& part : parts) {
        Cell box = common_part(part.box, cell);
        if (box.empty()) continue;
        if (box.lo != part.box.lo || box.hi != part.box.hi)
            box = common_part(box, part_in(triangles[part.triangle], cell));
        if (!box.empty()) found.push_back({part.triangle, box});
    }
    return found;
}

/// Where a cell is cut, and its children. No children: the cell becomes a leaf.
struct CellSplit {
    glm::vec3 plane{0};
    int axis = 0;
    std::vector<Cell> cells;
    std::vector<std::vector<Part>> parts;
};

template <class Split>
class CellBuilder {
public:
    CellBuilder(std::span<const LeafTriangle> triangles, const Split& split) : triangles_(triangles), split_(split) {
        if (triangles.empty()) return;
        std::vector<Part> parts;
        Cell all;
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            Cell box;
            for (const glm::vec3& corner : corners_of(triangles[i]))
                box = {glm::min(box.lo, corner), glm::max(box.hi, corner)};
            all = {glm::min(all.lo, box.lo), glm::max(all.hi, box.hi)};
            parts.push_back({i, box});
        }
        tree.nodes.emplace_back();
        build(0, all, std::move(parts), 0);
    }

    CellTree tree;

private:
    void build(std::uint32_t index, const Cell& cell, std::vector<Part> parts, unsigned depth) {
        tree.height = std::max(tree.height, depth);
        CellSplit split = split_(triangles_, cell, parts, depth);
        if (split.cells.empty()) {
            tree.nodes[index].first = std::uint32_t(tree.lists.size());
            tree.nodes[index].count = std::uint32_t(parts.size());
            for (const Part& part : parts) tree.lists.push_back(part.triangle);
            return;
        }
        parts = {};
        const auto first = std::uint32_t(tree.nodes.size());
        tree.nodes[index] = {
            {split.plane.x, split.plane.y, split.plane.z}, first, CLARAY_CELL_HAS_CHILDREN, std::uint32_t(split.axis)};
        tree.nodes.resize(first + split.cells.size());
        for (std::uint32_t k = 0; k < split.cells.size(); ++k)
            build(first + k, split.cells[k], std::move(split.parts[k]), depth + 1);
    }

    std::span<const LeafTriangle> triangles_;
    Split split_;
};

/// The part of a cell below a plane, or above it.
Cell side_of(Cell cell, int axis, float plane, bool above) {
    (above ? cell.lo : cell.hi)[axis] = plane;
    return cell;
}

// ---- octree
// ----------------------------------------------------------------------------------------------------------

constexpr std::size_t octree_leaf = 8;

struct OctreeSplit {
    unsigned most_levels;

    CellSplit operator()(std::span<const LeafTriangle> triangles, const Cell& cell, const std::vector<Part>& parts,
                         unsigned depth) const {
        CellSplit split;
        if (parts.size() <= octree_leaf || depth >= most_levels) return split;
        split.plane = 0.5f * cell.lo + 0.5f * cell.hi;
        std::size_t listed = 0;
        for (unsigned k = 0; k < 8; ++k) {
            Cell child = cell;
            for (int axis = 0; axis < 3; ++axis) child = side_of(child, axis, split.plane[axis], (k >> axis & 1) != 0);
            split.cells.push_back(child);
            split.parts.push_back(parts_in(triangles, parts, child));
            listed += split.parts.back().size();
        }
        // Where most triangles reach most children (at a shared vertex), a split only repeats them.
        return listed > 4 * parts.size() ? CellSplit{} : split;
    }
};

// ---- k-d tree
// --------------------------------------------------------------------------------------------------------

constexpr double visit_cost = 15, test_cost = 20, empty_bonus = 0.8;  // Wald and Havran 2006
constexpr std::size_t exact_from = 256;                               // fewer triangles: every border of a box is tried
constexpr unsigned bins = 32;                                         // else so many places along each axis

struct Plane {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    float at = 0;
};

std::vector<float> places_to_cut(const Cell& cell, const std::vector<Part>& parts, int axis) {
    std::vector<float> places;
    if (parts.size() < exact_from)
        for (const Part& part : parts) places.insert(places.end(), {part.box.lo[axis], part.box.hi[axis]});
    else
        for (unsigned i = 1; i < bins; ++i)
            places.push_back(cell.lo[axis] + (cell.hi[axis] - cell.lo[axis]) * (float(i) / bins));
    std::erase_if(places, [&](float place) { return !(place > cell.lo[axis] && place < cell.hi[axis]); });
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

/// The cheapest plane across one axis. A box in the plane itself goes below.
void try_planes(const Cell& cell, const std::vector<Part>& parts, int axis, Plane* best) {
    const std::vector<float> places = places_to_cut(cell, parts, axis);
    // Boxes that begin before place i, or lie in it; boxes that end at or before it.
    std::vector<std::size_t> begun(places.size() + 1), ended(places.size() + 1);
    for (const Part& part : parts) {
        const float lo = part.box.lo[axis], hi = part.box.hi[axis];
        const auto at_or_after = std::lower_bound(places.begin(), places.end(), hi);
        const auto first = lo == hi ? at_or_after : std::upper_bound(places.begin(), places.end(), lo);
        ++begun[std::size_t(first - places.begin())], ++ended[std::size_t(at_or_after - places.begin())];
    }
    std::size_t below = 0, gone = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        below += begun[i], gone += ended[i];
        const std::size_t above = parts.size() - gone;
        const double low = side_of(cell, axis, places[i], false).area() * double(below),
                     high = side_of(cell, axis, places[i], true).area() * double(above);
        double cost = visit_cost + test_cost * (low + high) / cell.area();
        if (below == 0 || above == 0) cost *= empty_bonus;
        if (cost < best->cost) *best = {cost, axis, places[i]};
    }
}

struct KdSplit {
    unsigned most_levels;

    CellSplit operator()(std::span<const LeafTriangle> triangles, const Cell& cell, const std::vector<Part>& parts,
                         unsigned depth) const {
        CellSplit split;
        if (parts.size() <= 1 || depth >= most_levels || !(cell.area() > 0)) return split;
        Plane best;
        for (int axis = 0; axis < 3; ++axis) try_planes(cell, parts, axis, &best);
        if (!(best.cost < test_cost * double(parts.size()))) return split;
        split.axis = best.axis, split.plane[best.axis] = best.at;
        std::vector<Part> below, above;
        for (const Part& part : parts) {
            const float lo = part.box.lo[best.axis], hi = part.box.hi[best.axis];
            if (lo < best.at || (lo == hi && lo == best.at)) below.push_back(part);
            if (hi > best.at) above.push_back(part);
        }
        split.cells = {side_of(cell, best.axis, best.at, false), side_of(cell, best.axis, best.at, true)};
        split.parts = {parts_in(triangles, below, split.cells[0]), parts_in(triangles, above, split.cells[1])};
        return split;
    }
};

unsigned levels_for(std::size_t triangles) { return unsigned(std::bit_width(triangles)); }

}  // namespace

CellTree build_octree(std::span<const LeafTriangle> triangles) {
    return CellBuilder(triangles, OctreeSplit{std::min(4 + levels_for(triangles.size()) / 2, 20u)}).tree;
}

CellTree build_kd_tree(std::span<const LeafTriangle> triangles) {
    return CellBuilder(triangles, KdSplit{8 + 13 * levels_for(triangles.size()) / 10}).tree;
}

}  // namespace claray
