#include "host/cli/load.hpp"

#include <algorithm>
#include <cmath>

#include "claray/error.hpp"
#include "host/cli/messages.hpp"

namespace claray::cli {
namespace {

/// Builders leave out what is not finite or huge, and no ray hits what has no area.
bool can_be_seen(const Mesh& mesh, const glm::uvec3& triangle) {
    constexpr float huge = 1e18f;
    glm::dvec3 corners[3];
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& p = mesh.positions[triangle[k]];
        if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= huge)) return false;
        corners[k] = p;
    }
    return glm::cross(corners[1] - corners[0], corners[2] - corners[0]) != glm::dvec3(0.);
}

}  // namespace

void print_warnings(const Warnings& warnings) {
    for (const std::string& warning : warnings) print_warning(warning);
}

void refuse_unseen(const std::string& name, const Scene& scene) {
    const bool any = std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& mesh) {
        return std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                           [&](const glm::uvec3& triangle) { return can_be_seen(mesh, triangle); });
    });
    const std::size_t triangles = triangle_count(scene);
    if (any || triangles == 0) return;
    throw Error(ErrorKind::user,
                "'" + name + "' shows nothing: its triangles, " + std::to_string(triangles) +
                    ", are all without area, not finite or beyond 1e18",
                "export the mesh again");
}

Scene load(const std::string& name, const LightOptions& lights) {
    Warnings warnings;
    Scene scene = load_scene(name, warnings);
    add_lights(scene, lights, warnings);
    print_warnings(warnings);
    refuse_unseen(name, scene);
    return scene;
}

}  // namespace claray::cli
