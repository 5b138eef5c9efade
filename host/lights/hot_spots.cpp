#include "host/lights/hot_spots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/lights/luminance.hpp"
#include "host/scene/placement.hpp"

namespace claray {
namespace {

using std::numbers::pi;
constexpr double gain = 0.5;    // see share_of
constexpr double near = 0.1;    // height over distance at which the spots of many lights may still pay
constexpr double most = 0.125;  // largest fraction of scattered rays that are aimed at hot spots

/// A light, and the nearest surface found so far, closer than `distance2`.
struct Candidate {
    std::size_t light = 0;
    glm::dvec3 position{0.0}, way{0.0};
    double share = 0;  // of the intensity of all points and spots
    double distance2 = 0;
    bool found = false;
};

/// The probability of aiming at a hot spot with the least noise. Let lights that share one spot have the fraction S of
/// all intensity and the height h, seen from the distance d. BSDF sampling finds their light c with the variance c^2
/// d^2 / 8 h^2 (the ratio of the integrals of squared and plain irradiance over a plane). Aiming with probability a has
/// the variance c^2 / a, and both combined about c^2 / (8 h^2 / d^2 + a). Aimed rays increase the noise V of all other
/// light by the factor a. a V + S^2 C / (8 h^2 / d^2 + a) is least for a = S sqrt(C / V) - 8 h^2 / d^2. The root is
/// `gain`, of which each light gets its part.
double share_of(double share, double of_all, double height2, double distance) {
    return share * (gain - 8 * height2 / (distance * distance * of_all));
}

glm::dvec3 nearest_of_edge(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 edge = b - a;
    const double length2 = glm::dot(edge, edge);
    return a + (length2 > 0 ? std::clamp(glm::dot(p - a, edge) / length2, 0.0, 1.0) : 0.0) * edge;
}

/// The nearest point of a triangle: the foot of the perpendicular if it is inside, else a point of an edge.
glm::dvec3 nearest_of_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const auto left_of = [&](const glm::dvec3& from, const glm::dvec3& to) {
        return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
    };
    const double length2 = glm::dot(normal, normal);
    if (length2 > 0 && left_of(a, b) && left_of(b, c) && left_of(c, a))
        return p - glm::dot(p - a, normal) / length2 * normal;
    glm::dvec3 nearest = nearest_of_edge(p, a, b);
    for (const glm::dvec3& other : {nearest_of_edge(p, b, c), nearest_of_edge(p, c, a)})
        if (glm::dot(other - p, other - p) < glm::dot(nearest - p, nearest - p)) nearest = other;
    return nearest;
}

/// Candidates by the cells of a grid, about one per cell. Puts them in the order of their cells.
class CandidateGrid {
public:
    explicit CandidateGrid(std::vector<Candidate>& candidates) : candidates_(candidates) {
        for (const Candidate& c : candidates) box_.grow(glm::vec3(c.position));
        const glm::dvec3 extent = glm::max(glm::dvec3(box_.extent()), 1e-3 * glm::length(glm::dvec3(box_.extent())));
        const double cell = std::cbrt(extent.x * extent.y * extent.z / double(candidates.size()));
        cells_per_length_ = cell > 0 ? 1 / cell : 0;
        last_ = cell_at(box_.hi);
        std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
            return number_of(cell_at(a.position)) < number_of(cell_at(b.position));
        });
        starts_.resize(number_of(last_) + 2);
        for (const Candidate& c : candidates) ++starts_[number_of(cell_at(c.position)) + 1];
        for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    }

    /// Calls `visit` for the candidates in the box and some near it, until it returns false.
    template <class Visit>
    void visit(const glm::dvec3& lo, const glm::dvec3& hi, const Visit& visit) const {
        for (int k = 0; k < 3; ++k)
            if (!(hi[k] >= box_.lo[k] && lo[k] <= box_.hi[k])) return;
        const glm::uvec3 first = cell_at(lo), last = cell_at(hi);
        for (std::uint32_t z = first.z; z <= last.z; ++z)
            for (std::uint32_t y = first.y; y <= last.y; ++y) {
                const std::size_t end = starts_[number_of({last.x, y, z}) + 1];
                for (std::size_t i = starts_[number_of({first.x, y, z})]; i < end; ++i)
                    if (!visit(candidates_[i])) return;
            }
    }
    [[nodiscard]] const Bounds& box() const { return box_; }

private:
    static constexpr double most_cells = 255;  // per axis, less one

    /// The nearest cell.
    [[nodiscard]] glm::uvec3 cell_at(const glm::dvec3& point) const {
        const glm::dvec3 cell = cells_per_length_ * (point - glm::dvec3(box_.lo));
        return glm::uvec3(glm::min(glm::max(glm::dvec3(0.0), cell), glm::min(glm::dvec3(last_), most_cells)));
    }
    [[nodiscard]] std::size_t number_of(const glm::uvec3& cell) const {
        return (std::size_t(cell.z) * (last_.y + 1) + cell.y) * (last_.x + 1) + cell.x;
    }

    std::vector<Candidate>& candidates_;
    Bounds box_;
    double cells_per_length_ = 0;
    glm::uvec3 last_{std::numeric_limits<std::uint32_t>::max()};  // cell
    std::vector<std::size_t> starts_;                             // of each cell, and the end of the last
};

/// Searches for the nearest surface of each light, within the relevant distance.
class Search {
public:
    Search(const std::vector<Candidate>& candidates, const CandidateGrid& grid, const Scene& scene)
        : grid_(grid), scene_(scene) {
        for (const Candidate& c : candidates) reach_ = std::max(reach_, std::sqrt(c.distance2));
    }
    void run() {
        if (scene_.instances.empty())
            for (const Mesh& mesh : scene_.meshes) visit(mesh, glm::dmat4(1.0));
        std::vector<Bounds> boxes;
        if (!scene_.instances.empty())
            for (const Mesh& mesh : scene_.meshes) boxes.push_back(bounds_of(mesh));
        for (const MeshInstance& instance : scene_.instances) {
            const glm::dmat4 transform(instance.transform);
            if (!moves(instance) && is_near(boxes[instance.mesh], transform))
                visit(scene_.meshes[instance.mesh], transform);
        }
    }

private:
    /// Returns whether some light may be close to the contents of the box.
    [[nodiscard]] bool is_near(const Bounds& box, const glm::dmat4& transform) const {
        if (box.empty()) return false;
        const glm::dvec3 center(transform * glm::dvec4(box.center(), 1.0)), half(0.5f * box.extent());
        for (int k = 0; k < 3; ++k) {
            double reach = reach_;
            for (int i = 0; i < 3; ++i) reach += std::abs(transform[i][k]) * half[i];
            reach += 1e-5 * (std::abs(center[k]) + reach);
            if (center[k] + reach < grid_.box().lo[k] || center[k] - reach > grid_.box().hi[k]) return false;
        }
        return true;
    }
    void visit(const Mesh& mesh, const glm::dmat4& transform) {
        if (transform == glm::dmat4(1.0)) return visit(mesh.triangles, mesh.positions);
        std::vector<glm::dvec3> corners(mesh.positions.begin(), mesh.positions.end());
        for (glm::dvec3& corner : corners) corner = glm::dvec3(transform * glm::dvec4(corner, 1.0));
        visit(mesh.triangles, corners);
    }
    template <class Vector>
    void visit(const std::vector<glm::uvec3>& triangles, const std::vector<Vector>& corners) {
        for (const glm::uvec3& t : triangles)
            visit(glm::dvec3(corners[t.x]), glm::dvec3(corners[t.y]), glm::dvec3(corners[t.z]));
    }
    void visit(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const glm::dvec3 lo = glm::min(glm::min(a, b), c), hi = glm::max(glm::max(a, b), c);
        grid_.visit(lo - reach_, hi + reach_, [&](Candidate& at) {
            const glm::dvec3 off = glm::max(glm::max(lo - at.position, at.position - hi), glm::dvec3(0.0));
            if (!(glm::dot(off, off) < at.distance2)) return true;
            const glm::dvec3 way = nearest_of_triangle(at.position, a, b, c) - at.position;
            const double distance2 = glm::dot(way, way);
            if (distance2 < at.distance2) at.distance2 = distance2, at.way = way, at.found = true;
            return true;
        });
    }

    const CandidateGrid& grid_;
    const Scene& scene_;
    double reach_ = 0;
};

/// The approximate power of all lights except lamps and environment maps. Distant lights count by their flux through
/// the scene's cross section.
double total_intensity(const Scene& scene, double radius) {
    double total = 0.25 * pi * radius * radius * luminance(0.5f * (scene.sky.horizon + scene.sky.zenith));
    for (const Light& light : scene.lights)
        total += luminance(light.intensity) * (light.kind == LightKind::directional ? 0.25 * radius * radius : 1);
    return total;
}

/// The point lights that are considered.
std::vector<Candidate> candidates_of(const Scene& scene, double distance) {
    const double total = total_intensity(scene, 2 * distance);
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        const bool inverse_square = light.attenuation.x == 0.f && light.attenuation.y == 0.f;
        if (light.kind != LightKind::point || !(luminance(light.intensity) > 0) || !inverse_square) continue;
        Candidate candidate{i, light.position};
        candidate.share = luminance(light.intensity) / total;
        candidate.distance2 = std::max(candidate.share * gain / 8, near * near) * distance * distance;
        if (light.range > 0) candidate.distance2 = std::min(candidate.distance2, double(light.range) * light.range);
        candidates.push_back(candidate);
    }
    return candidates;
}

/// The shares of the lights whose spots overlap with that of `c`: at most two heights away. Stops counting at
/// `enough`.
double share_around(const CandidateGrid& grid, const Candidate& c, double enough) {
    const double reach = 2 * std::sqrt(c.distance2);
    double sum = 0;
    grid.visit(c.position - reach, c.position + reach, [&](const Candidate& other) {
        const glm::dvec3 off = other.position - c.position;
        if (glm::dot(off, off) <= reach * reach) sum += other.share;
        return sum < enough;
    });
    return std::max(sum, c.share);
}

/// Lowers the distance within which a light's surface matters: the spot of a light pays up to a height that follows
/// from the shares around it, of which there are fewer within a lower height.
void lower_distances(std::vector<Candidate>& candidates, const CandidateGrid& grid, double distance) {
    for (int pass = 0; pass < 3; ++pass)
        for (Candidate& c : candidates)
            c.distance2 = std::min(c.distance2, share_around(grid, c, 1) * gain / 8 * distance * distance);
}

}  // namespace

std::vector<HotSpotPlace> find_hot_spots(const Scene& scene) {
    std::vector<HotSpotPlace> places;
    const Bounds bounds = bounds_of(scene);
    if (bounds.empty()) return places;
    const double distance =
        0.25 * glm::length(glm::dvec3(bounds.extent()));  // typical distance from which spots are seen
    std::vector<Candidate> candidates = candidates_of(scene, distance);
    if (candidates.empty()) return places;
    const CandidateGrid grid(candidates);
    lower_distances(candidates, grid, distance);
    Search(candidates, grid, scene).run();
    double sum = 0;
    for (const Candidate& c : candidates) {
        const glm::vec3 way(c.way);
        if (!c.found || !(glm::dot(way, way) > 1e-30f)) continue;  // the light is in the surface
        const double pays =
            4 * 8 * c.distance2 / (distance * distance * gain);  // far from where the spot ceases to pay
        const double share = share_of(c.share, share_around(grid, c, pays), c.distance2, distance);
        if (!(share > 0)) continue;
        places.push_back({c.light, way, share});
        sum += share;
    }
    std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.light < b.light; });
    for (HotSpotPlace& place : places) place.probability *= std::min(1.0, most / sum);
    return places;
}

}  // namespace claray
