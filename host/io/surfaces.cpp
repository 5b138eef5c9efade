// Sets which sides of surfaces are visible, and which side is the front.
#include <utility>

#include "claray/io.hpp"

namespace claray {
namespace {

/// Light leaves a solid through back sides.
bool is_solid_glass(const Material& m) {
    const bool lets_through = transmits(m.kind) || (m.kind == MaterialKind::principled && m.transmission > 0.f);
    return lets_through && !m.thin_walled;
}

}  // namespace

void set_culling(Scene& scene, Culling culling) {
    if (culling == Culling::by_file) return;
    for (Material& material : scene.materials)
        material.cull_back = culling == Culling::back && !is_solid_glass(material);
}

void flip_fronts(Scene& scene) {
    for (Mesh& mesh : scene.meshes)
        for (glm::uvec3& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
}

}  // namespace claray
