// What light passes between surfaces. Transparent bodies may have something within: other bodies, lamps, lights. Rays
// must know the media that they are in there (kernels/shade/media.clh).
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>
#include <unordered_map>

#include "host/bsdf/material_data.hpp"
#include "host/effects/parts/part.hpp"
#include "host/lights/lights.hpp"

namespace claray {
namespace {

constexpr double growth = 1e-5;  // of touching bodies, as a share of their size and distance from the origin

/// The triangles of one material in a mesh.
struct Part {
    std::uint32_t mesh, material;
    std::vector<std::size_t> triangles;
    Bounds bounds;  // in the mesh's space
};

/// A placed part.
struct Body {
    const Part* part;
    glm::mat4 transform;
    Bounds bounds;  // in the world
};

/// The transparent bodies of a scene.
struct Bodies {
    std::vector<Part> parts;
    std::vector<Body> all;  // they refer to `parts`
};

std::uint32_t material_of(const Mesh& mesh, std::size_t triangle) {
    return mesh.materials.empty() ? 0u : mesh.materials[triangle];
}

glm::vec3 placed_corner(const Mesh& mesh, const glm::mat4& transform, std::uint32_t vertex) {
    return glm::vec3(transform * glm::vec4(mesh.positions[vertex], 1.f));
}

Bounds bounds_of(const Mesh& mesh, const glm::mat4& transform, std::size_t triangle) {
    Bounds bounds;
    for (int k = 0; k < 3; ++k) bounds.grow(placed_corner(mesh, transform, mesh.triangles[triangle][k]));
    return bounds;
}

/// Grown by a share of its size; less than 0: shrunk.
Bounds grown(const Bounds& bounds, float share) {
    const glm::vec3 by = share * bounds.extent();
    return {bounds.lo - by, bounds.hi + by};
}

bool overlap(const Bounds& a, const Bounds& b) {
    return glm::all(glm::lessThanEqual(a.lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, a.hi));
}

/// Calls call(mesh number, transform) for every placed mesh.
template <class Call>
void for_placed_meshes(const Scene& scene, Call call) {
    if (scene.instances.empty())
        for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) call(i, glm::mat4(1.f));
    for (const MeshInstance& instance : scene.instances)
        if (instance.mesh < scene.meshes.size()) call(instance.mesh, instance.transform);
}

Bounds placed(const Bounds& bounds, const glm::mat4& transform) {
    Bounds found;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at = glm::mix(bounds.lo, bounds.hi, glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2));
        found.grow(glm::vec3(transform * glm::vec4(at, 1.f)));
    }
    return found;
}

void add_parts(const Scene& scene, std::uint32_t number, std::vector<Part>& parts) {
    const Mesh& mesh = scene.meshes[number];
    const std::size_t first = parts.size();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::uint32_t material = material_of(mesh, t);
        if (material >= scene.materials.size() || !has_glass(scene.materials[material])) continue;
        auto part = std::find_if(parts.begin() + std::ptrdiff_t(first), parts.end(),
                                 [&](const Part& p) { return p.material == material; });
        if (part == parts.end()) part = parts.insert(part, Part{number, material, {}, {}});
        part->triangles.push_back(t);
        const Bounds bounds = bounds_of(mesh, glm::mat4(1.f), t);
        part->bounds.grow(bounds.lo), part->bounds.grow(bounds.hi);
    }
}

Bodies transparent_bodies(const Scene& scene) {
    Bodies bodies;
    if (std::none_of(scene.materials.begin(), scene.materials.end(), has_glass)) return bodies;
    std::vector<std::size_t> ends;  // of each mesh's parts
    for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
        add_parts(scene, i, bodies.parts);
        ends.push_back(bodies.parts.size());
    }
    for_placed_meshes(scene, [&](std::uint32_t number, const glm::mat4& transform) {
        for (std::size_t p = number == 0 ? 0 : ends[number - 1]; p < ends[number]; ++p)
            bodies.all.push_back({&bodies.parts[p], transform, placed(bodies.parts[p].bounds, transform)});
    });
    return bodies;
}

/// Of each vertex the first one in the same place: within 1e-5 of the mesh's size, because the ends of a seam are often
/// rounded differently.
std::vector<std::uint32_t> welded(const Mesh& mesh) {
    const Bounds bounds = claray::bounds_of(mesh);
    const double reach = std::max(1e-5 * double(glm::length(bounds.extent())), 1e-30);
    const auto cell_of = [&](const glm::dvec3& p) {
        return glm::i64vec3(glm::floor((p - glm::dvec3(bounds.lo)) / (2 * reach)));
    };
    const auto hash = [](const glm::i64vec3& c) {
        return std::uint64_t(c.x) * 73856093u ^ std::uint64_t(c.y) * 19349663u ^ std::uint64_t(c.z) * 83492791u;
    };
    std::unordered_multimap<std::uint64_t, std::uint32_t> firsts;
    std::vector<std::uint32_t> same(mesh.positions.size());
    for (std::uint32_t v = 0; v < same.size(); ++v) {
        const glm::dvec3 p = mesh.positions[v];
        same[v] = v;
        // A cell is as wide as the reach on both sides together: it and its nearest neighbours hold all in reach.
        for (int corner = 0; corner < 8 && same[v] == v; ++corner) {
            const glm::dvec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            const auto [begin, end] = firsts.equal_range(hash(cell_of(p + reach * side)));
            for (auto it = begin; it != end && same[v] == v; ++it)
                if (glm::distance(glm::dvec3(mesh.positions[it->second]), p) <= reach) same[v] = it->second;
        }
        if (same[v] == v) firsts.emplace(hash(cell_of(p)), v);
    }
    return same;
}

/// Whether each edge of these triangles is passed as often in one direction as in the other.
bool is_closed(const Mesh& mesh, const std::vector<std::size_t>& triangles) {
    const std::vector<std::uint32_t> same = welded(mesh);
    std::vector<std::pair<std::uint64_t, int>> edges;
    for (const std::size_t t : triangles)
        for (int k = 0; k < 3; ++k) {
            const std::uint64_t a = same[mesh.triangles[t][k]], b = same[mesh.triangles[t][(k + 1) % 3]];
            if (a != b) edges.emplace_back(std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1);
        }
    std::sort(edges.begin(), edges.end());
    int sum = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        sum += edges[i].second;
        if (i + 1 < edges.size() && edges[i + 1].first == edges[i].first) continue;
        if (sum != 0) return false;
    }
    return !edges.empty();
}

/// Whether a point is in a body: a ray from there leaves it more often than it enters it.
bool is_in(const Scene& scene, const Body& body, const glm::dvec3& from) {
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.6180339, 0.3141592, 0.7182818));
    const Mesh& mesh = scene.meshes[body.part->mesh];
    int crossings = 0;
    for (const std::size_t t : body.part->triangles) {
        glm::dvec3 v[3];
        for (int k = 0; k < 3; ++k) v[k] = glm::dvec3(placed_corner(mesh, body.transform, mesh.triangles[t][k])) - from;
        const auto side = [&](int a, int b) { return glm::dot(towards, glm::cross(v[a], v[b])); };
        const double s[] = {side(1, 2), side(2, 0), side(0, 1)};
        const bool out = s[0] >= 0 && s[1] >= 0 && s[2] >= 0, in = s[0] < 0 && s[1] < 0 && s[2] < 0;
        if (!(out || in) || s[0] + s[1] + s[2] == 0) continue;
        const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
        if (glm::dot(normal, v[0]) / glm::dot(normal, towards) > 0) crossings += out ? 1 : -1;
    }
    return crossings != 0;
}

/// The corners of a triangle's part in a box, their middle, and points halfway to it (Sutherland and Hodgman 1974,
/// "Reentrant polygon clipping").
std::vector<glm::dvec3> points_in(const Bounds& box, const Mesh& mesh, const glm::mat4& transform,
                                  std::size_t triangle) {
    std::vector<glm::dvec3> polygon;
    for (int k = 0; k < 3; ++k) polygon.emplace_back(placed_corner(mesh, transform, mesh.triangles[triangle][k]));
    for (int plane = 0; plane < 6 && !polygon.empty(); ++plane) {
        const int axis = plane / 2;
        const double side = plane % 2 ? 1 : -1, limit = plane % 2 ? double(box.hi[axis]) : -double(box.lo[axis]);
        std::vector<glm::dvec3> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double from = side * p[axis] - limit, to = side * q[axis] - limit;
            if (from <= 0) kept.push_back(p);
            if ((from < 0 && to > 0) || (from > 0 && to < 0)) kept.push_back(glm::mix(p, q, from / (from - to)));
        }
        polygon = kept;
    }
    if (polygon.empty()) return polygon;
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& p : polygon) middle += p / double(polygon.size());
    for (std::size_t i = polygon.size(); i-- > 0;) polygon.push_back(0.5 * (polygon[i] + middle));
    polygon.push_back(middle);
    return polygon;
}

/// Whether a triangle that is not the body's own reaches into it. `boxes`: of the meshes. After some points near the
/// body, which may be of a dense mesh, the answer is yes: knowing media then costs less than more points.
bool meets_triangles(const Scene& scene, const std::vector<Bounds>& boxes, const Body& body) {
    const Bounds inner = grown(body.bounds, -1e-4f);
    int points = 1024;
    bool found = false;
    const auto reaches_in = [&](const Mesh& mesh, const glm::mat4& transform, std::size_t t) {
        if (!overlap(inner, bounds_of(mesh, transform, t))) return false;
        for (const glm::dvec3& point : points_in(inner, mesh, transform, t))
            if (--points < 0 || is_in(scene, body, point)) return true;
        return false;
    };
    for_placed_meshes(scene, [&](std::uint32_t number, const glm::mat4& transform) {
        if (found || boxes[number].empty() || !overlap(inner, placed(boxes[number], transform))) return;
        const Mesh& mesh = scene.meshes[number];
        const bool same = number == body.part->mesh && transform == body.transform;
        for (std::size_t t = 0; t < mesh.triangles.size() && !found; ++t)
            if (!(same && material_of(mesh, t) == body.part->material)) found = reaches_in(mesh, transform, t);
    });
    return found;
}

bool touch(const Body& a, const Body& b) { return overlap(grown(a.bounds, 1e-4f), grown(b.bounds, 1e-4f)); }

/// Whether anything may lie within the body.
bool is_occupied(const Scene& scene, const std::vector<Bounds>& boxes, const std::vector<Body>& bodies,
                 const Body& body) {
    for (const Body& other : bodies)
        if (&other != &body && touch(body, other)) return true;
    for (const Light& light : scene.lights)
        if (!traits_of(light.kind)->far && overlap(body.bounds, {light.position, light.position})) return true;
    for (const PrimitiveSet& set : scene.primitives)
        if (overlap(grown(body.bounds, -1e-4f), claray::bounds_of(set))) return true;
    return meets_triangles(scene, boxes, body);
}

/// Whether one body is within the other, as 32 points just below its surface say.
bool is_within(const Scene& scene, const Body& body, const Body& other) {
    constexpr std::size_t points = 32;
    const Mesh& mesh = scene.meshes[body.part->mesh];
    const double depth = 1e-4 * double(glm::length(body.bounds.extent()));
    for (std::size_t i = 0; i < points; ++i) {
        const glm::uvec3 corners = mesh.triangles[body.part->triangles[i * body.part->triangles.size() / points]];
        glm::dvec3 v[3];
        for (int k = 0; k < 3; ++k) v[k] = placed_corner(mesh, body.transform, corners[k]);
        const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
        const double length = glm::length(normal);
        if (length > 0 && !is_in(scene, other, (v[0] + v[1] + v[2]) / 3.0 - depth / length * normal)) return false;
    }
    return true;
}

/// For each material, how many others have a body around one of its own.
std::vector<int> depths(const Scene& scene, const std::vector<Body>& bodies) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> within;
    for (const Body& body : bodies)
        for (const Body& other : bodies) {
            const std::pair pair(body.part->material, other.part->material);
            if (pair.first != pair.second && !within.contains(pair) && touch(body, other) &&
                is_within(scene, body, other))
                within.insert(pair);
        }
    std::vector<int> found(scene.materials.size());
    for (const auto& [material, around] : within) ++found[material];
    return found;
}

/// The closed bodies, if any of them is occupied.
Bodies nested_bodies(const Scene& scene) {
    Bodies bodies = transparent_bodies(scene);
    if (bodies.all.empty()) return bodies;
    const std::vector<Bounds> boxes = bounds_of_meshes(scene);
    const bool any = std::any_of(bodies.all.begin(), bodies.all.end(),
                                 [&](const Body& body) { return is_occupied(scene, boxes, bodies.all, body); });
    if (!any) return {};
    std::set<std::uint32_t> open;
    for (const Part& part : bodies.parts)
        if (!open.contains(part.material) && !is_closed(scene.meshes[part.mesh], part.triangles))
            open.insert(part.material);
    std::erase_if(bodies.all, [&](const Body& body) { return open.contains(body.part->material); });
    return bodies;
}

std::vector<std::uint32_t> ranked(const Scene& scene, const std::vector<Body>& bodies) {
    std::vector<std::uint32_t> materials;
    for (const Body& body : bodies) materials.push_back(body.part->material);
    std::sort(materials.begin(), materials.end());
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    const std::vector<int> depth = depths(scene, bodies);
    std::stable_sort(materials.begin(), materials.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(depth[a], scene.materials[a].ior) < std::pair(depth[b], scene.materials[b].ior);
    });
    constexpr std::size_t most = 0xffff;  // 16 bits in kernels/shade/media.clh
    if (materials.size() > most) materials.resize(most);
    return materials;
}

/// Moves the faces of a body outwards by at least `distance`, in the mesh's units.
void grow_part(Mesh& mesh, const Part& part, double distance) {
    const std::vector<std::uint32_t> same = welded(mesh);
    std::vector<glm::dvec3> sums(mesh.positions.size());
    std::vector<double> least(sums.size(), 1);
    const auto for_faces = [&](auto call) {
        for (const std::size_t t : part.triangles) {
            const glm::uvec3 v = mesh.triangles[t];
            const glm::dvec3 a = mesh.positions[v.x], b = mesh.positions[v.y], c = mesh.positions[v.z];
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            const double length = glm::length(normal);
            for (int k = 0; k < 3 && length > 0; ++k) call(same[v[k]], normal / length);
        }
    };
    for_faces([&](std::uint32_t v, const glm::dvec3& normal) { sums[v] += normal; });
    for (glm::dvec3& sum : sums)
        if (const double length = glm::length(sum); length > 0) sum /= length;
    for_faces(
        [&](std::uint32_t v, const glm::dvec3& normal) { least[v] = std::min(least[v], glm::dot(sums[v], normal)); });
    std::vector<bool> moves(sums.size());
    for (const std::size_t t : part.triangles)
        for (int k = 0; k < 3; ++k) moves[mesh.triangles[t][k]] = true;
    for (std::size_t v = 0; v < sums.size(); ++v)
        if (moves[v]) mesh.positions[v] += glm::vec3(distance / std::max(least[same[v]], 0.25) * sums[same[v]]);
}

/// `growth` of the body's size and distance from the origin, in the mesh's units.
double growth_of(const Body& body) {
    const glm::vec3 farthest = glm::max(glm::abs(body.bounds.lo), glm::abs(body.bounds.hi));
    const double scale = std::cbrt(std::abs(double(glm::determinant(glm::mat3(body.transform)))));
    return growth * double(glm::length(body.bounds.extent()) + glm::length(farthest)) / std::max(scale, 1e-30);
}

/// The materials of transparent bodies by their rank, the lowest first: where bodies overlap, the last of them is
/// there. A body within another one outranks it; else the higher index of refraction does. Empty if nothing lies
/// within any body. Materials of open meshes are left out, since their bodies have no inside.
std::vector<std::uint32_t> nested_media(const Scene& scene) { return ranked(scene, nested_bodies(scene).all); }

/// The scene with bodies that touch overlapping: those of lower rank grow by 1e-5 of their size, far more than rounding
/// and far less than is visible. Rays would see only one of two borders in the same place. Nothing if none touch.
std::optional<Scene> with_overlapping_media(const Scene& scene) {
    const Bodies bodies = nested_bodies(scene);
    const std::vector<std::uint32_t> ranks = ranked(scene, bodies.all);
    const auto rank = [&](const Body& body) {
        return std::find(ranks.begin(), ranks.end(), body.part->material) - ranks.begin();
    };
    std::optional<Scene> changed;
    std::set<const Part*> grew;  // once, although there may be several instances
    for (const Body& body : bodies.all) {
        const bool meets_higher = std::any_of(bodies.all.begin(), bodies.all.end(), [&](const Body& other) {
            return touch(body, other) && rank(other) > rank(body);
        });
        if (!meets_higher || !grew.insert(body.part).second) continue;
        if (!changed) changed = scene;
        grow_part(changed->meshes[body.part->mesh], *body.part, growth_of(body));
    }
    return changed;
}

/// Of each material the rank of its medium, from 1 on; 0: none. Of each medium four floats: its index of refraction,
/// and its absorption per unit of length.
EffectTables tables_of_media(const Scene& scene) {
    const std::vector<std::uint32_t> media = nested_media(scene);
    std::vector<std::uint32_t> ranks(media.empty() ? 0 : scene.materials.size()), words;
    for (const std::uint32_t medium : media) {
        const glm::vec3 absorption = absorption_of(scene.materials[medium]);
        for (const float value : {scene.materials[medium].ior, absorption.x, absorption.y, absorption.z})
            words.push_back(std::bit_cast<std::uint32_t>(value));
        ranks[medium] = std::uint32_t(words.size() / 4);
    }
    return {{&SceneTables::media_ranks, ranks}, {&SceneTables::media, words}};
}

void find_nested_media(const SearchedScene& searched, const Found& found) {
    for (const std::uint32_t medium : nested_media(searched.scene))
        found("material", searched.scene.materials[medium].name, medium);
}

void strip_nested_media(Scene& scene) {
    for (const std::uint32_t medium : nested_media(scene)) scene.materials[medium].kind = MaterialKind::lambert;
}

constexpr std::array medium_parts = {
    EffectPart{.effect = Effect::absorption,
               .in_material = absorbs_inside,
               .strip_material = [](Material& m) { m.attenuation_distance = 0.f; },
               .show =
                   [](Scene& s) {
                       make_glass(s);
                       ball_of(s).attenuation = {0.2f, 0.7f, 0.5f}, ball_of(s).attenuation_distance = 0.6f;
                   }},
    EffectPart{.effect = Effect::nested_media,
               .find = find_nested_media,
               .strip = strip_nested_media,
               .prepare = with_overlapping_media,
               .tables = tables_of_media,
               .show = [](Scene& s) {
                   make_glass(s);
                   s.meshes.push_back(scenes::textured_ball({-0.35f, 0.8f, 0.f}, 0.4f, 3, scenes::block_material));
               }}};

}  // namespace

std::span<const EffectPart> parts_of_media() { return medium_parts; }

}  // namespace claray
