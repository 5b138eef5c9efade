// What lies under a pixel.
#pragma once

#include <optional>
#include <string>

#include "claray/scene.hpp"

namespace claray::view {

struct Selection {
    std::uint32_t mesh = 0, material = 0, triangle = 0;
    std::optional<std::uint32_t> instance;
};

/// Returns what a triangle belongs to. Triangles are counted through the meshes of the scene, in order. Of the
/// instances of a mesh, it is the one whose triangle is nearest to the point.
[[nodiscard]] Selection selection_of(const Scene& scene, std::uint32_t triangle, const glm::vec3& point);

/// Returns the names of the effects that the triangle, its material and its instance use.
[[nodiscard]] std::string effects_of_surface(const Scene& scene, const Selection& selection);

}  // namespace claray::view
