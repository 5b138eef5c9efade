#include "claray/scene.hpp"

namespace claray {

Bounds bounds_of(const Mesh& mesh) {
    Bounds bounds;
    for (const glm::vec3& p : mesh.positions)
        if (!glm::any(glm::isnan(p)) && !glm::any(glm::isinf(p))) bounds.grow(p);
    return bounds;
}

/// Every kind is inside of the balls around its points; the second points of discs are normals.
Bounds bounds_of(const PrimitiveSet& set) {
    Bounds bounds;
    const bool discs = set.kind == PrimitiveSet::Kind::discs, cylinders = set.kind == PrimitiveSet::Kind::cylinders;
    for (std::size_t i = 0; i < set.points.size(); i += discs ? 2 : 1) {
        const glm::vec3 center(set.points[i]), reach(cylinders ? set.points[i - i % 2].w : set.points[i].w);
        for (const glm::vec3& p : {center - reach, center + reach})
            if (!glm::any(glm::isnan(p)) && !glm::any(glm::isinf(p))) bounds.grow(p);
    }
    return bounds;
}

namespace {

/// Of a box that is placed in the world: that of its corners.
void grow(Bounds& bounds, const Bounds& part, const glm::mat4& transform) {
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p(corner & 1 ? part.hi.x : part.lo.x, corner & 2 ? part.hi.y : part.lo.y,
                          corner & 4 ? part.hi.z : part.lo.z);
        const glm::vec3 placed(transform * glm::vec4(p, 1.f));
        if (!glm::any(glm::isnan(placed)) && !glm::any(glm::isinf(placed))) bounds.grow(placed);
    }
}

}  // namespace

Bounds bounds_of(const Scene& scene) { return bounds_of(scene, bounds_of_meshes(scene)); }

std::vector<Bounds> bounds_of_meshes(const Scene& scene) {
    std::vector<Bounds> parts;
    for (const Mesh& mesh : scene.meshes) parts.push_back(bounds_of(mesh));
    return parts;
}

Bounds bounds_of(const Scene& scene, std::span<const Bounds> parts) {
    Bounds bounds;
    if (scene.instances.empty())
        for (const Bounds& part : parts)
            if (!part.empty()) bounds.grow(part.lo), bounds.grow(part.hi);
    for (const MeshInstance& instance : scene.instances) {
        if (instance.mesh >= parts.size() || parts[instance.mesh].empty()) continue;
        grow(bounds, parts[instance.mesh], instance.transform);
        if (instance.transform_end) grow(bounds, parts[instance.mesh], *instance.transform_end);
    }
    for (const PrimitiveSet& set : scene.primitives)
        if (const Bounds part = bounds_of(set); !part.empty()) bounds.grow(part.lo), bounds.grow(part.hi);
    return bounds;
}

std::size_t triangle_count(const Scene& scene) {
    std::size_t count = 0;
    if (scene.instances.empty())
        for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
    for (const MeshInstance& instance : scene.instances)
        if (instance.mesh < scene.meshes.size()) count += scene.meshes[instance.mesh].triangles.size();
    return count;
}

}  // namespace claray
