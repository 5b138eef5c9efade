#include "host/io/strokes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/scene/builtin/shapes.hpp"
#include "host/scene/validate.hpp"

namespace claray {
namespace {

struct PlaceHash {
    std::size_t operator()(const glm::vec3& p) const {
        std::uint64_t h = 0;
        for (int k = 0; k < 3; ++k) h = (h ^ std::bit_cast<std::uint32_t>(p[k])) * 0x9e3779b97f4a7c15u;
        return std::size_t(h ^ (h >> 32));
    }
};

/// Calls sphere(vertex, material) and tube(vertex, vertex, material). Places that several strokes share get one sphere.
template <class Sphere, class Tube>
void for_each_part(const Strokes& strokes, const Sphere& sphere, const Tube& tube) {
    std::unordered_set<glm::vec3, PlaceHash> places;
    for (std::size_t i = 0; i < strokes.triangles.size(); ++i) {
        const std::uint32_t a = strokes.triangles[i].x, b = strokes.triangles[i].y;
        const std::uint32_t material = strokes.materials.empty() ? 0 : strokes.materials[i];
        for (const std::uint32_t end : {a, b})
            if (places.insert(strokes.positions[end]).second) sphere(end, material);
        if (strokes.positions[a] != strokes.positions[b]) tube(a, b, material);
    }
}

class Solids {
public:
    Solids(const Strokes& strokes, float radius)
        : strokes_(strokes),
          radius_(radius),
          sphere_(scenes::make_sphere(glm::vec3(0.f), 1.f, levels_for(strokes.triangles.size()), 0)),
          sides_(strokes.triangles.size() > 30'000 ? 8 : 16) {
        solid_.name = strokes.name;
        solid_.mask = strokes.mask;
    }

    Mesh take() {
        for_each_part(
            strokes_,
            [&](std::uint32_t at, std::uint32_t material) {
                material_ = material;
                add_sphere(at);
            },
            [&](std::uint32_t a, std::uint32_t b, std::uint32_t material) {
                material_ = material;
                add_tube(a, b);
            });
        return std::move(solid_);
    }

private:
    static unsigned levels_for(std::size_t strokes) { return strokes <= 3'000 ? 2 : strokes <= 30'000 ? 1 : 0; }

    void add_vertex(const glm::vec3& position, const glm::vec3& normal, std::uint32_t of) {
        solid_.positions.push_back(position);
        solid_.normals.push_back(normal);
        if (!strokes_.uvs.empty()) solid_.uvs.push_back(strokes_.uvs[of]);
        if (!strokes_.uvs1.empty()) solid_.uvs1.push_back(strokes_.uvs1[of]);
        if (!strokes_.colors.empty()) solid_.colors.push_back(strokes_.colors[of]);
    }
    void add_triangle(const glm::uvec3& triangle) {
        solid_.triangles.push_back(triangle);
        solid_.materials.push_back(material_);
    }

    void add_sphere(std::uint32_t at) {
        const auto first = std::uint32_t(solid_.positions.size());
        for (const glm::vec3& n : sphere_.positions) add_vertex(strokes_.positions[at] + radius_ * n, n, at);
        for (const glm::uvec3& t : sphere_.triangles) add_triangle(first + t);
    }

    void add_tube(std::uint32_t a, std::uint32_t b) {
        const glm::dvec3 along = glm::normalize(glm::dvec3(strokes_.positions[b]) - glm::dvec3(strokes_.positions[a]));
        const glm::dvec3 across = std::abs(along.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        const glm::dvec3 u = glm::normalize(glm::cross(along, across)), v = glm::cross(along, u);
        const auto first = std::uint32_t(solid_.positions.size());
        for (std::uint32_t side = 0; side < sides_; ++side) {
            const double angle = 2 * std::numbers::pi * side / sides_;
            const glm::vec3 normal(std::cos(angle) * u + std::sin(angle) * v);
            for (const std::uint32_t end : {a, b}) add_vertex(strokes_.positions[end] + radius_ * normal, normal, end);
            const std::uint32_t here = first + 2 * side, next = first + 2 * ((side + 1) % sides_);
            add_triangle({here, next, next + 1});
            add_triangle({here, next + 1, here + 1});
        }
    }

    const Strokes& strokes_;
    float radius_;
    Mesh sphere_;
    std::uint32_t sides_, material_ = 0;
    Mesh solid_;
};

bool suits_primitives(const Material& m, bool has_holes) {
    return (m.alpha_mode == AlphaMode::opaque || !has_holes) && may_be_on_primitives(m);
}

/// One set of its kind, with the colours of the strokes' vertices at the ends of each primitive.
PrimitiveSet empty_set(const Strokes& strokes, PrimitiveSet::Kind kind) {
    PrimitiveSet set;
    set.name = strokes.name, set.kind = kind;
    return set;
}

void add_colors(PrimitiveSet& set, const Strokes& strokes, std::uint32_t a, std::uint32_t b) {
    if (strokes.colors.empty()) return;
    set.colors.emplace_back(strokes.colors[a]);
    set.colors.emplace_back(strokes.colors[b]);
}

/// Whether all materials of the strokes satisfy `condition`.
template <class Condition>
bool all_materials(const Strokes& strokes, const std::vector<Material>& materials, const Condition& condition) {
    if (strokes.materials.empty()) return condition(materials.at(0));
    return std::all_of(strokes.materials.begin(), strokes.materials.end(),
                       [&](std::uint32_t material) { return condition(materials.at(material)); });
}

/// Whether primitives show the strokes as well as triangles. They are not sampled as lights, but many lamps of many
/// triangles take long.
bool suit_primitives(const Strokes& strokes, const std::vector<Material>& materials, bool few) {
    const bool holes =
        std::any_of(strokes.colors.begin(), strokes.colors.end(), [](const glm::vec4& c) { return c.w < 1.f; });
    return all_materials(strokes, materials, [&](const Material& m) {
        return !(few && m.emission != glm::vec3(0.f)) && suits_primitives(m, holes);
    });
}

/// Exactly round.
std::vector<PrimitiveSet> primitive_strokes(const Strokes& strokes, float radius) {
    PrimitiveSet spheres = empty_set(strokes, PrimitiveSet::Kind::spheres),
                 tubes = empty_set(strokes, PrimitiveSet::Kind::cylinders);
    for_each_part(
        strokes,
        [&](std::uint32_t at, std::uint32_t material) {
            spheres.points.emplace_back(strokes.positions[at], radius);
            spheres.materials.push_back(material);
            add_colors(spheres, strokes, at, at);
        },
        [&](std::uint32_t a, std::uint32_t b, std::uint32_t material) {
            tubes.points.emplace_back(strokes.positions[a], radius);
            tubes.points.emplace_back(strokes.positions[b], 0.f);  // open, because spheres close it
            tubes.materials.push_back(material);
            add_colors(tubes, strokes, a, b);
        });
    std::vector<PrimitiveSet> sets = {std::move(spheres)};
    if (!tubes.points.empty()) sets.push_back(std::move(tubes));
    return sets;
}

Bounds bounds_of_all(const Scene& scene, const std::vector<Strokes>& all) {
    Bounds bounds = bounds_of(scene);
    for (const Strokes& strokes : all) {
        const Bounds box = bounds_of(strokes);
        if (!box.empty()) bounds.grow(box.lo), bounds.grow(box.hi);
    }
    return bounds;
}

}  // namespace

float stroke_radius(const Bounds& bounds, std::size_t strokes) {
    const float diagonal = bounds.empty() ? 0.f : glm::length(bounds.extent());
    if (!(diagonal > 0.f && std::isfinite(diagonal))) return 1.f;
    return diagonal / std::max(400.f, 2.f * std::sqrt(float(strokes)));
}

Mesh solid_strokes(const Strokes& strokes, float radius) { return Solids(strokes, radius).take(); }

void add_strokes(Scene& scene, const std::vector<Strokes>& all, std::optional<float> given, Warnings& warnings) {
    if (all.empty()) return;
    constexpr std::size_t few = 64;
    std::size_t count = 0;
    for (const Strokes& strokes : all) count += strokes.triangles.size();
    const float radius = given ? *given : stroke_radius(bounds_of_all(scene, all), count);
    if (!(radius >= 0.f && std::isfinite(radius)))
        throw Error(ErrorKind::usage, "invalid stroke radius " + std::to_string(radius),
                    "give a finite radius, 0 or more");
    const std::string what = std::to_string(all.size()) + " primitives of points or lines are ";
    if (radius == 0.f) return warnings.push_back(what + "left out, as requested");
    for (const Strokes& strokes : all) {
        if (suit_primitives(strokes, scene.materials, count <= few)) {
            for (PrimitiveSet& set : primitive_strokes(strokes, radius)) scene.primitives.push_back(std::move(set));
            continue;
        }
        if (!scene.instances.empty())
            scene.instances.push_back({std::uint32_t(scene.meshes.size()), glm::mat4(1.f), {}});
        scene.meshes.push_back(solid_strokes(strokes, radius));
    }
    warnings.push_back(what + printed("shown as spheres and tubes of radius %.3g: choose another radius with "
                                      "--stroke-radius",
                                      double(radius)));
}

}  // namespace claray
