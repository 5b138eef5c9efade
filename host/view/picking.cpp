#include "host/view/picking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "claray/effects.hpp"
#include "host/scene/placement.hpp"

namespace claray::view {
namespace {

float distance_from_segment(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 along = b - a;
    const float square = glm::dot(along, along);
    const float t = square > 0 ? std::clamp(glm::dot(p - a, along) / square, 0.f, 1.f) : 0.f;
    return glm::length(p - a - t * along);
}

float distance_from_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 normal = glm::cross(b - a, c - a);
    const auto inside = [&](const glm::vec3& from, const glm::vec3& to) {
        return glm::dot(glm::cross(to - from, p - from), normal) >= 0;
    };
    if (inside(a, b) && inside(b, c) && inside(c, a) && glm::length(normal) > 0)
        return std::abs(glm::dot(p - a, glm::normalize(normal)));
    return std::min({distance_from_segment(p, a, b), distance_from_segment(p, b, c), distance_from_segment(p, c, a)});
}

/// The triangle as a mesh of its own.
Mesh alone(const Mesh& mesh, std::uint32_t triangle) {
    const glm::uvec3 corners = mesh.triangles[triangle];
    const auto of_corners = [&](const auto& values) {
        std::decay_t<decltype(values)> some;
        for (int k = 0; k < 3 && !values.empty(); ++k) some.push_back(values[corners[k]]);
        return some;
    };
    Mesh one;
    one.positions = of_corners(mesh.positions), one.normals = of_corners(mesh.normals);
    one.uvs = of_corners(mesh.uvs), one.uvs1 = of_corners(mesh.uvs1);
    one.tangents = of_corners(mesh.tangents), one.colors = of_corners(mesh.colors);
    one.triangles = {{0, 1, 2}};
    return one;
}

}  // namespace

Selection selection_of(const Scene& scene, std::uint32_t triangle, const glm::vec3& point) {
    Selection found;
    std::size_t first = 0;
    while (triangle - first >= scene.meshes[found.mesh].triangles.size())
        first += scene.meshes[found.mesh++].triangles.size();
    const Mesh& mesh = scene.meshes[found.mesh];
    found.triangle = std::uint32_t(triangle - first);
    found.material = mesh.materials.empty() ? 0 : mesh.materials[found.triangle];
    const glm::uvec3 corners(mesh.triangles[found.triangle]);
    float nearest = std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].mesh != found.mesh) continue;
        const glm::mat4& transform = scene.instances[i].transform;
        const auto corner = [&](unsigned k) { return glm::vec3(transform * glm::vec4(mesh.positions[corners[k]], 1)); };
        const float distance = distance_from_triangle(point, corner(0), corner(1), corner(2));
        if (!found.instance || distance < nearest) found.instance = i, nearest = distance;
    }
    return found;
}

std::string effects_of_surface(const Scene& scene, const Selection& selection) {
    Scene one;
    one.materials = {scene.materials[selection.material]};
    one.textures = scene.textures;
    one.meshes = {alone(scene.meshes[selection.mesh], selection.triangle)};
    if (selection.instance && moves(scene.instances[*selection.instance])) {
        one.instances = {scene.instances[*selection.instance]};
        one.instances[0].mesh = 0;
    }
    return to_string(effects_of(one));
}

}  // namespace claray::view
