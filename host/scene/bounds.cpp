#include "claray/scene.hpp"

namespace claray {

Bounds bounds_of(const Mesh& mesh) {
    Bounds bounds;
    for (const glm::vec3& p : mesh.positions)
        if (!glm::any(glm::isnan(p)) && !glm::any(glm::isinf(p))) bounds.grow(p);
    return bounds;
}

Bounds bounds_of(const Scene& scene) {
    Bounds bounds;
    for (const Mesh& mesh : scene.meshes) {
        const Bounds part = bounds_of(mesh);
        if (part.empty()) continue;
        bounds.grow(part.lo);
        bounds.grow(part.hi);
    }
    return bounds;
}

std::size_t triangle_count(const Scene& scene) {
    std::size_t count = 0;
    for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
    return count;
}

}  // namespace claray
