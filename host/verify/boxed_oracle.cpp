#include "host/verify/boxed_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/base/in_parallel.hpp"

namespace claray::verify {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double padding = 1e-6;  // of the largest coordinate: far more than the roundings of all tests in float64

}  // namespace

BoxedOracle::BoxedOracle(std::span<const Mesh> meshes) {
    std::vector<Corners> triangles;
    for (const Mesh& mesh : meshes)
        for (const glm::uvec3& t : mesh.triangles)
            triangles.push_back({{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}});
    numbers_.resize(triangles.size());
    std::iota(numbers_.begin(), numbers_.end(), 0u);
    if (!triangles.empty()) (void)add_node(triangles, 0, triangles.size());
    std::vector<glm::dvec3> corners;
    for (const std::uint32_t number : numbers_)
        corners.insert(corners.end(), std::begin(triangles[number].at), std::end(triangles[number].at));
    oracle_.emplace(corners);
}

std::size_t BoxedOracle::add_node(std::span<const Corners> triangles, std::size_t begin, std::size_t end) {
    glm::dvec3 lo(infinity), hi(-infinity);
    for (std::size_t i = begin; i < end; ++i)
        for (const glm::dvec3& corner : triangles[numbers_[i]].at) lo = min(lo, corner), hi = max(hi, corner);
    for (int axis = 0; axis < 3; ++axis) size_ = std::max({size_, std::fabs(lo[axis]), std::fabs(hi[axis])});
    const std::size_t node = nodes_.size();
    nodes_.push_back({lo, hi, std::uint32_t(begin), std::uint32_t(end), 0});
    const std::size_t blocks = (end - begin + Oracle::block - 1) / Oracle::block;
    if (blocks == 1) return node;
    const glm::dvec3 extent = hi - lo;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t middle = begin + blocks / 2 * Oracle::block;
    const auto place = [&](std::uint32_t i) {
        const auto sum = triangles[i].at[0][axis] + triangles[i].at[1][axis] + triangles[i].at[2][axis];
        return sum == sum ? sum : 0;  // NaN has no order; such triangles are never hit
    };
    const auto at = [&](std::size_t i) { return numbers_.begin() + std::ptrdiff_t(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](auto a, auto b) { return place(a) < place(b); });
    (void)add_node(triangles, begin, middle);
    const std::size_t second_half = add_node(triangles, middle, end);
    nodes_[node].second_half = std::uint32_t(second_half);
    return node;
}

double BoxedOracle::entry(const Node& node, const Ray& ray, double limit) const {
    const glm::dvec3 o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    const double pad = padding * std::max({size_, std::fabs(o.x), std::fabs(o.y), std::fabs(o.z)});
    double enter = -infinity, leave = infinity;
    for (int axis = 0; axis < 3; ++axis) {
        const double below = node.lo[axis] - pad - o[axis], above = node.hi[axis] + pad - o[axis];
        if (d[axis] == 0) {
            if (below > 0 || above < 0) return infinity;
            continue;
        }
        enter = std::max(enter, std::min(below / d[axis], above / d[axis]));
        leave = std::min(leave, std::max(below / d[axis], above / d[axis]));
    }
    return enter > leave || leave < ray.tmin || enter > limit ? infinity : enter;
}

void BoxedOracle::search(std::size_t index, const Ray& ray, OracleHit& hit) const {
    const Node& node = nodes_[index];
    if (node.second_half == 0) {
        for (std::size_t at = node.begin; at < node.end; at += Oracle::block) oracle_->test_block(ray, at, hit);
        return;
    }
    std::size_t halves[2] = {index + 1, node.second_half};
    double entries[2] = {entry(nodes_[halves[0]], ray, hit.t), entry(nodes_[halves[1]], ray, hit.t)};
    if (entries[1] < entries[0]) std::swap(halves[0], halves[1]), std::swap(entries[0], entries[1]);
    if (entries[0] < infinity) search(halves[0], ray, hit);
    if (entries[1] < infinity && entries[1] <= hit.t) search(halves[1], ray, hit);
}

std::vector<OracleHit> BoxedOracle::closest_hits(std::span<const Ray> rays) const {
    constexpr std::size_t together = 256;
    std::vector<OracleHit> hits(rays.size());
    in_parallel((rays.size() + together - 1) / together, [&](std::size_t piece) {
        for (std::size_t i = piece * together; i < std::min((piece + 1) * together, rays.size()); ++i) {
            OracleHit hit{rays[i].tmax, CLARAY_MISS};
            if (!nodes_.empty()) search(0, rays[i], hit);
            if (hit.primitive != CLARAY_MISS) hit.primitive = numbers_[hit.primitive];
            hits[i] = hit;
        }
    });
    return hits;
}

}  // namespace claray::verify
