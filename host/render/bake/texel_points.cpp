#include "host/render/bake/texel_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "claray/error.hpp"

namespace claray {
namespace {

constexpr double reach = 1.0;    // largest distance, in texels, from a centre to the mesh
constexpr double inside = 1e-3;  // barycentric weights above this are not on an edge

/// A triangle in texels.
struct Flat {
    glm::dvec2 a, e1, e2;
    double det;

    /// Weights of the second and the third corner.
    [[nodiscard]] glm::dvec2 weights(const glm::dvec2& p) const {
        const glm::dvec2 s = p - a;
        return {(s.x * e2.y - s.y * e2.x) / det, (e1.x * s.y - e1.y * s.x) / det};
    }
    /// The same for the nearest point of the triangle.
    [[nodiscard]] glm::dvec2 nearest(const glm::dvec2& p) const {
        const glm::dvec2 w = weights(p);
        if (w.x >= 0 && w.y >= 0 && w.x + w.y <= 1) return w;
        const auto along = [&](const glm::dvec2& from, const glm::dvec2& edge) {
            const double length2 = glm::dot(edge, edge);
            return length2 > 0 ? std::clamp(glm::dot(p - from, edge) / length2, 0.0, 1.0) : 0.0;
        };
        const double s = along(a, e1), t = along(a, e2), r = along(a + e1, e2 - e1);
        glm::dvec2 best(s, 0);
        for (const glm::dvec2& other : {glm::dvec2(0, t), glm::dvec2(1 - r, r)})
            if (distance(p, other) < distance(p, best)) best = other;
        return best;
    }
    [[nodiscard]] double distance(const glm::dvec2& p, const glm::dvec2& w) const {
        return glm::length(a + w.x * e1 + w.y * e2 - p);
    }
};

struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    Hit hit{};
    bool inside = false;
};

}  // namespace

TexelPoints find_texel_points(const Mesh& mesh, const std::vector<glm::vec2>& uvs, unsigned width, unsigned height,
                              std::uint32_t first_triangle, const std::string& name) {
    std::vector<Nearest> nearest(std::size_t(width) * height);
    std::size_t covered = 0, twice = 0;
    const glm::dvec2 size(width, height);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3 t = mesh.triangles[i];
        glm::dvec2 corners[3];
        for (int k = 0; k < 3; ++k) {
            const glm::vec2 uv = uvs[t[k]];
            if (!(uv.x >= 0.f && uv.x <= 1.f && uv.y >= 0.f && uv.y <= 1.f))
                throw Error(ErrorKind::user,
                            name + ": the light map coordinates of triangle " + std::to_string(i) + " are outside 0..1",
                            "unwrap the mesh into the unit square");
            corners[k] = glm::dvec2(uv) * size;
        }
        const Flat flat{corners[0], corners[1] - corners[0], corners[2] - corners[0],
                        (corners[1].x - corners[0].x) * (corners[2].y - corners[0].y) -
                            (corners[1].y - corners[0].y) * (corners[2].x - corners[0].x)};
        if (flat.det == 0) continue;
        const glm::dvec2 lo = glm::min(glm::min(corners[0], corners[1]), corners[2]) - reach;
        const glm::dvec2 hi = glm::max(glm::max(corners[0], corners[1]), corners[2]) + reach;
        const int x0 = std::max(0, int(lo.x)), x1 = std::min(int(width) - 1, int(hi.x));
        const int y0 = std::max(0, int(lo.y)), y1 = std::min(int(height) - 1, int(hi.y));
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const glm::dvec2 center(x + 0.5, y + 0.5), w = flat.nearest(center), exact = flat.weights(center);
                const double distance = flat.distance(center, w);
                Nearest& best = nearest[std::size_t(y) * width + std::size_t(x)];
                const bool within = exact.x > inside && exact.y > inside && exact.x + exact.y < 1 - inside;
                covered += within, twice += within && best.inside;
                if (distance < reach && distance < best.distance) {
                    best.distance = distance;
                    best.hit = {1.f, float(w.x), float(w.y), first_triangle + std::uint32_t(i), 0};
                }
                best.inside = best.inside || within;
            }
    }
    if (twice > covered / 1000)
        throw Error(ErrorKind::user, name + ": several triangles cover the same texels of the light map",
                    "use coordinates without overlaps, or more texels");
    TexelPoints found;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        if (!(nearest[i].distance < reach)) continue;
        found.texels.push_back(std::uint32_t(i));
        found.points.push_back(nearest[i].hit);
    }
    return found;
}

}  // namespace claray
