#include "host/scene/placement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace claray {
namespace {

constexpr double unit_roundoff = 0x1p-24;
constexpr double largest_bend = 1e-3;

/// Returns whether rounding its corners to float32 bends a triangle noticeably.
bool is_bent(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 size = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
    const double edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    return unit_roundoff * std::max({size.x, size.y, size.z}) > largest_bend * edge;
}

std::vector<std::uint32_t> first_triangles_of(const Scene& scene) {
    std::vector<std::uint32_t> first;
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) {
        first.push_back(std::uint32_t(triangles));
        triangles += mesh.triangles.size();
    }
    return first;
}

/// A copy without meshes and instances.
Scene without_meshes(const Scene& scene) {
    Scene copy;
    copy.name = scene.name;
    copy.primitives = scene.primitives;
    copy.materials = scene.materials;
    copy.textures = scene.textures;
    copy.lights = scene.lights;
    copy.sky = scene.sky;
    copy.environment = scene.environment;
    copy.camera = scene.camera;
    return copy;
}

}  // namespace

bool survives_baking(const Mesh& mesh, const glm::mat4& transform) {
    if (transform == glm::mat4(1.f)) return true;
    const glm::dmat4 m(transform);
    const auto world = [&](const glm::dvec3& p) { return glm::dvec3(m * glm::dvec4(p, 1.0)); };
    return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const glm::uvec3& t) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        return !is_bent(world(a), world(b), world(c)) || is_bent(a, b, c);
    });
}

void TriangleNumbers::add(std::uint32_t first, std::size_t triangles) {
    here_.push_back(next_);
    there_.push_back(first);
    next_ += std::uint32_t(triangles);
}

std::uint32_t TriangleNumbers::number_there(std::uint32_t triangle) const {
    const std::uint32_t mesh = mesh_of(triangle);
    return mesh == CLARAY_MISS ? triangle : there_[mesh] + (triangle - here_[mesh]);
}

std::uint32_t TriangleNumbers::mesh_of(std::uint32_t triangle) const {
    if (triangle >= next_) return CLARAY_MISS;
    return std::uint32_t(std::upper_bound(here_.begin(), here_.end(), triangle) - here_.begin()) - 1;
}

Mesh transformed(const Mesh& mesh, const glm::mat4& transform) {
    if (transform == glm::mat4(1.f)) return mesh;
    Mesh baked = mesh;
    const glm::dmat4 m(transform);
    const glm::dmat3 linear(m), normals = glm::transpose(glm::inverse(linear));
    const bool mirrors = glm::determinant(linear) < 0;
    const auto unit = [](const glm::dvec3& v) {
        const double length = glm::length(v);
        return length > 0 ? glm::vec3(v / length) : glm::vec3(v);
    };
    for (glm::vec3& p : baked.positions) p = glm::vec3(m * glm::dvec4(p, 1.0));
    // Scaled by one common factor, so that interpolated normals equal the transformed normals of the object.
    const double shrink = std::cbrt(std::abs(glm::determinant(linear)));
    for (glm::vec3& n : baked.normals) n = glm::vec3(shrink * (normals * glm::dvec3(n)));
    for (glm::vec4& t : baked.tangents) t = glm::vec4(unit(linear * glm::dvec3(t.x, t.y, t.z)), mirrors ? -t.w : t.w);
    if (mirrors)
        for (glm::uvec3& t : baked.triangles) std::swap(t.y, t.z);
    return baked;
}

PlacedScene place_instances(const Scene& scene) {
    PlacedScene placed;
    placed.scene = without_meshes(scene);
    const std::vector<std::uint32_t> first = first_triangles_of(scene);
    std::vector<std::size_t> uses(scene.meshes.size());
    for (const MeshInstance& instance : scene.instances) ++uses[instance.mesh];

    std::vector<MeshInstance> others;
    for (const MeshInstance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        InstancePlace& place = placed.places.emplace_back();
        if (mesh.triangles.empty()) continue;
        if (uses[instance.mesh] > 1 || moves(instance) || !survives_baking(mesh, instance.transform)) {
            place.index = std::uint32_t(others.size());
            others.push_back(instance);
            continue;
        }
        place = {true, std::uint32_t(placed.scene.meshes.size())};
        placed.scene.meshes.push_back(transformed(mesh, instance.transform));
        placed.numbers.add(first[instance.mesh], mesh.triangles.size());
    }
    placed.baked = placed.scene.meshes.size();
    if (others.empty()) return placed;
    for (InstancePlace& place : placed.places)
        if (!place.baked && place.index != CLARAY_MISS) place.index += std::uint32_t(placed.baked);

    for (std::uint32_t i = 0; i < placed.baked; ++i) placed.scene.instances.push_back({i});
    std::vector<std::uint32_t> index(scene.meshes.size(), CLARAY_MISS);
    for (MeshInstance& instance : others) {
        std::uint32_t& at = index[instance.mesh];
        if (at == CLARAY_MISS) {
            at = std::uint32_t(placed.scene.meshes.size());
            placed.scene.meshes.push_back(scene.meshes[instance.mesh]);
            placed.numbers.add(first[instance.mesh], placed.scene.meshes.back().triangles.size());
        }
        instance.mesh = at;
        placed.scene.instances.push_back(instance);
    }
    return placed;
}

}  // namespace claray
