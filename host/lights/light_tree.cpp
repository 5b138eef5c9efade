#include "host/lights/light_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/lights/number_shares.hpp"

namespace claray {
namespace {

constexpr float half_turn = std::numbers::pi_v<float>;
constexpr int width = CLARAY_LIGHT_TREE_WIDTH;
constexpr int bins = 12;
constexpr float least_radius = 1e-18f;  // of lights at one place, so that its sign tells that they differ
constexpr float edge_margin = 4e-6f;    // of cosines and ranges, so that rounding removes no light that contributes

/// Consecutive elements of the array of light numbers that is being sorted.
struct LightRange {
    std::size_t begin = 0, end = 0;
    [[nodiscard]] std::size_t size() const { return end - begin; }
};

/// The values by which a split is judged.
struct Summary {
    Bounds box;
    glm::vec3 axes{0.f};  // sum of intensity times axis
    float intensity = 0;
    bool ranged = true;  // no light is unlimited

    void add(const LightBounds& light, const glm::vec3& reference) {
        box.grow(light.box.lo), box.grow(light.box.hi);
        const bool turn = light.two_sided && glm::dot(light.axis, reference) < 0.f;
        if (light.spread < half_turn) axes += turn ? -light.intensity * light.axis : light.intensity * light.axis;
        intensity += light.intensity;
        ranged = ranged && light.range > 0;
    }
    void add(const Summary& other) {
        if (!other.box.empty()) box.grow(other.box.lo), box.grow(other.box.hi);
        axes += other.axes, intensity += other.intensity;
        ranged = ranged && other.ranged;
    }
    /// Intensity times the squared diagonal (which is positive for lines, too), times 1 if all directions agree, up to
    /// 2 if they do not. With ranges the cubed diagonal: the larger the volume, the fewer of its lights reach a point.
    [[nodiscard]] float cost() const {
        if (box.empty() || !(intensity > 0)) return 0;
        const glm::vec3 e = box.extent();
        const float size2 = glm::dot(e, e), size = ranged ? size2 * std::sqrt(size2) : size2;
        return intensity * size * (2.f - std::min(glm::length(axes) / intensity, 1.f));
    }
};

/// A cone around two cones.
void join_cones(LightBounds& a, const LightBounds& b) {
    if (a.spread >= half_turn || b.spread >= half_turn || a.two_sided != b.two_sided) {
        a.spread = half_turn, a.reach = half_turn, a.two_sided = false;
        return;
    }
    a.reach = std::max(a.reach, b.reach);
    glm::vec3 other = b.axis;
    if (a.two_sided && glm::dot(a.axis, other) < 0.f) other = -other;
    const float between = std::acos(std::clamp(glm::dot(a.axis, other), -1.f, 1.f));
    if (between + b.spread <= a.spread) return;
    if (between + a.spread <= b.spread) {
        a.axis = other, a.spread = b.spread;
        return;
    }
    const float spread = 0.5f * (a.spread + b.spread + between) + 1e-4f;  // acos has this error near 0
    const glm::vec3 tangent = other - glm::dot(a.axis, other) * a.axis;
    if (spread >= half_turn || glm::length(tangent) < 1e-4f) {
        a.spread = spread >= half_turn ? half_turn : spread + 1e-3f;
        if (spread < half_turn) a.spread = std::max(a.spread, b.spread + between);
        return;
    }
    const float turn = spread - a.spread;
    a.axis = glm::normalize(std::cos(turn) * a.axis + std::sin(turn) * glm::normalize(tangent));
    a.spread = spread;
}

class LightTreeBuilder {
public:
    explicit LightTreeBuilder(const std::vector<LightBounds>& lights) : lights_(lights), order_(lights.size()) {
        for (std::size_t i = 0; i < lights.size(); ++i) order_[i] = std::uint32_t(i);
        tree_.trails.resize(lights.size());
        build({0, lights.size()}, 0, 0);
        share_numbers();
    }
    [[nodiscard]] LightTree take() { return std::move(tree_); }

private:
    [[nodiscard]] const LightBounds& light(std::size_t i) const { return lights_[order_[i]]; }
    [[nodiscard]] std::vector<LightRange> children_of(LightRange range, unsigned level);
    [[nodiscard]] std::size_t split(LightRange range);
    [[nodiscard]] float cost(LightRange range) const;
    [[nodiscard]] LightBounds bounds_of(LightRange range, float& radius2) const;
    [[nodiscard]] bool alike(LightRange range, const LightBounds& bounds) const;
    std::uint32_t build(LightRange range, unsigned level, std::uint32_t trail);
    void share_numbers();

    const std::vector<LightBounds>& lights_;
    std::vector<std::uint32_t> order_;
    std::vector<std::array<LightRange, width>> ranges_;  // of the nodes' children
    LightTree tree_;
};

float LightTreeBuilder::cost(LightRange range) const {
    Summary summary;
    for (std::size_t i = range.begin; i < range.end; ++i) summary.add(light(i), light(range.begin).axis);
    return summary.cost();
}

/// Sorts the range and returns where to cut it in two: at the cheapest of 11 planes along each axis of the centres'
/// box.
std::size_t LightTreeBuilder::split(LightRange range) {
    Bounds centers;
    for (std::size_t i = range.begin; i < range.end; ++i) centers.grow(light(i).box.center());
    const glm::vec3 reference = light(range.begin).axis, extent = centers.extent();
    const auto bin_of = [&](const LightBounds& l, int axis) {
        const float at = (l.box.center()[axis] - centers.lo[axis]) / extent[axis];
        return std::clamp(int(at * bins), 0, bins - 1);
    };
    float best = INFINITY;
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(extent[axis] > 0)) continue;
        std::array<Summary, bins> summaries;
        for (std::size_t i = range.begin; i < range.end; ++i)
            summaries[bin_of(light(i), axis)].add(light(i), reference);
        std::array<float, bins> above{};
        Summary sum;
        for (int b = bins - 1; b > 0; --b) sum.add(summaries[b]), above[b] = sum.cost();
        sum = {};
        const float thin = std::max({extent.x, extent.y, extent.z}) / extent[axis];  // prefer to cut long sides
        for (int b = 0; b + 1 < bins; ++b) {
            sum.add(summaries[b]);
            const float total = thin * (sum.cost() + above[b + 1]);
            if (total < best) best = total, best_axis = axis, best_bin = b;
        }
    }
    const std::size_t half = range.begin + range.size() / 2;
    if (best_axis < 0) return half;
    const auto middle =
        std::partition(order_.begin() + std::ptrdiff_t(range.begin), order_.begin() + std::ptrdiff_t(range.end),
                       [&](std::uint32_t l) { return bin_of(lights_[l], best_axis) <= best_bin; });
    const auto cut = std::size_t(middle - order_.begin());
    return cut == range.begin || cut == range.end ? half : cut;
}

/// Cuts the costliest part in two until there are four. If the trail might become too long, cuts into four equal parts.
std::vector<LightRange> LightTreeBuilder::children_of(LightRange range, unsigned level) {
    const std::uint64_t most = std::uint64_t(1) << 2 * (CLARAY_LIGHT_TREE_HEIGHT - 1 - level);  // below a child
    std::vector<LightRange> parts = {range};
    std::vector<float> costs = {1.f};
    while (parts.size() < width) {
        std::size_t next = parts.size();
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (parts[i].size() > 1 && (next == parts.size() || costs[i] > costs[next])) next = i;
        if (next == parts.size()) break;
        const LightRange part = parts[next];
        const std::size_t cut = split(part);
        parts[next] = {part.begin, cut}, costs[next] = cost(parts[next]);
        const auto after = std::ptrdiff_t(next) + 1;  // the order in space is kept, see descend_tree
        parts.insert(parts.begin() + after, {cut, part.end});
        costs.insert(costs.begin() + after, cost({cut, part.end}));
    }
    const bool too_deep = std::any_of(parts.begin(), parts.end(), [&](LightRange part) { return part.size() > most; });
    if (!too_deep) return parts;
    parts.clear();
    for (std::size_t i = 0; i < width; ++i)
        parts.push_back({range.begin + range.size() * i / width, range.begin + range.size() * (i + 1) / width});
    return parts;
}

LightBounds LightTreeBuilder::bounds_of(LightRange range, float& radius2) const {
    LightBounds all = light(range.begin);
    for (std::size_t i = range.begin + 1; i < range.end; ++i) {
        all.box.grow(light(i).box.lo), all.box.grow(light(i).box.hi);
        all.intensity += light(i).intensity;
        const bool unlimited = all.range == 0.f || light(i).range == 0.f,
                   cones = all.cone_scale > 0 && light(i).cone_scale > 0;
        all.range = unlimited ? 0.f : std::max(all.range, light(i).range);
        all.cone_scale = cones ? std::max(all.cone_scale, light(i).cone_scale) : 0.f;
        join_cones(all, light(i));
    }
    radius2 = 0;
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const glm::vec3 far =
            glm::max(glm::abs(light(i).box.lo - all.box.center()), glm::abs(light(i).box.hi - all.box.center()));
        radius2 = std::max(radius2, glm::dot(far, far));
    }
    return all;
}

/// Returns whether these lights differ from far away only in intensity: they emit in all directions, or in about one
/// direction, without an edge.
bool LightTreeBuilder::alike(LightRange range, const LightBounds& bounds) const {
    for (std::size_t i = range.begin; i < range.end; ++i)
        if (light(i).range > 0 || light(i).cone_scale > 0) return false;
    if (bounds.spread < 0.3f) return true;
    for (std::size_t i = range.begin; i < range.end; ++i)
        if (light(i).spread < half_turn || light(i).reach < half_turn) return false;
    return true;
}

std::uint32_t LightTreeBuilder::build(LightRange range, unsigned level, std::uint32_t trail) {
    const auto index = std::uint32_t(tree_.nodes.size());
    tree_.nodes.emplace_back(), ranges_.emplace_back();
    const std::vector<LightRange> parts = children_of(range, level);
    std::copy(parts.begin(), parts.end(), ranges_[index].begin());
    LightNode node{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        float radius2 = 0;
        const LightBounds bounds = bounds_of(parts[i], radius2);
        node.radius[i] = alike(parts[i], bounds) ? std::sqrt(radius2) : -std::max(std::sqrt(radius2), least_radius);
        const glm::vec3 center = bounds.box.center();
        node.x[i] = center.x, node.y[i] = center.y, node.z[i] = center.z;
        node.axis_x[i] = bounds.axis.x, node.axis_y[i] = bounds.axis.y, node.axis_z[i] = bounds.axis.z;
        node.cos_spread[i] = bounds.spread >= half_turn ? -1.f : std::cos(bounds.spread);
        node.sin_spread[i] = bounds.spread >= half_turn ? 0.f : std::sin(bounds.spread);
        node.cos_reach[i] = bounds.two_sided ? CLARAY_TWO_SIDED_CONE : std::cos(std::min(bounds.reach, half_turn));
        if (bounds.cone_scale > 0) node.cos_reach[i] -= edge_margin, node.cone_scale[i] = bounds.cone_scale;
        if (bounds.range > 0) node.near_range[i] = 1 / (bounds.range * (1 + edge_margin));
        node.intensity[i] = bounds.intensity;
        const std::uint32_t below = trail | std::uint32_t(i) << 2 * level;
        if (parts[i].size() == 1) {
            node.child[i] = CLARAY_LIGHT_LEAF | order_[parts[i].begin];
            tree_.trails[order_[parts[i].begin]] = below;
        } else {
            node.child[i] = build(parts[i], level + 1, below);
        }
    }
    tree_.nodes[index] = node;
    return index;
}

/// Assigns numbers to the leaves, and to each child the consecutive numbers of its lights.
void LightTreeBuilder::share_numbers() {
    const std::size_t count = order_.size();
    double total = 0;
    for (const LightBounds& light : lights_) total += light.intensity;
    NumberShares shares(total, count);
    tree_.leaves.resize(count), tree_.places.resize(count);
    std::uint64_t cell = 0;  // the next cell without a start
    for (std::size_t i = 0; i < count; ++i) {
        const NumberShares::Share share = shares.next(light(i).intensity);
        tree_.leaves[i].light = order_[i], tree_.leaves[i].first = share.first, tree_.leaves[i].last = share.last;
        tree_.places[order_[i]] = std::uint32_t(i);
        for (; cell < count && ((cell << 32) + count - 1) / count <= share.last; ++cell)
            tree_.leaves[cell].start = std::uint32_t(i);
    }
    for (std::size_t node = 0; node < tree_.nodes.size(); ++node)
        for (std::size_t i = 0; i < width; ++i) {
            const LightRange range = ranges_[node][i];
            if (range.size() == 0) continue;
            tree_.nodes[node].first[i] = tree_.leaves[range.begin].first;
            tree_.nodes[node].span[i] = tree_.leaves[range.end - 1].last - tree_.leaves[range.begin].first + 1;
        }
}

}  // namespace

LightTree build_light_tree(const std::vector<LightBounds>& lights) { return LightTreeBuilder(lights).take(); }

}  // namespace claray
