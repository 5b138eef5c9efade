// Simple shapes of which the built-in scenes are put together. Triangles are counter-clockwise seen from outside.
#pragma once

#include <functional>

#include "claray/scene.hpp"

namespace claray::scenes {

/// Returns a mesh without triangles, with memory reserved for so many vertices and triangles.
[[nodiscard]] Mesh named_mesh(const char* name, std::size_t vertices = 0, std::size_t triangles = 0);

/// Adds one triangle, with its own three vertices, of material `material`.
void add_triangle(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t material);
/// Adds the quadrilateral a b c d as two triangles that share their vertices.
void add_quad(Mesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d,
              std::uint32_t material);
/// Adds a rectangle at `center`, spanned by the half edges `u` and `v`; it faces cross(u, v).
void add_rectangle(Mesh& mesh, const glm::vec3& center, const glm::vec3& u, const glm::vec3& v, std::uint32_t material);
/// Adds a box with chamfered edges: 6 faces, 12 edges, 8 corners, 44 triangles. The columns of `axes` are its half
/// edges, at right angles to each other; `bevel` is the width cut off, in units of length.
void add_beveled_box(Mesh& mesh, const glm::vec3& center, const glm::mat3& axes, float bevel, std::uint32_t material);
/// Adds a frustum about the y axis without its caps: `sides` quadrilaterals, or triangles where `top_radius` is 0.
void add_frustum(Mesh& mesh, const glm::vec3& base, float base_radius, float top_radius, float height, unsigned sides,
                 std::uint32_t material);

/// An icosahedron whose triangles were split in four `levels` times, on the sphere, with smooth normals:
/// 20 * 4^levels triangles.
[[nodiscard]] Mesh make_sphere(const glm::vec3& center, float radius, unsigned levels, std::uint32_t material);

/// A square of columns x columns cells in the x-z plane from -half to half, two triangles a cell, with smooth normals.
/// No materials: the caller adds what it wants per triangle.
[[nodiscard]] Mesh make_height_field(unsigned columns, float half, const std::function<double(double, double)>& height);

/// A square lamp of side 2 * `half` at `position` that faces `target`.
[[nodiscard]] Mesh make_lamp(const glm::vec3& position, const glm::vec3& target, float half, std::uint32_t material);

[[nodiscard]] Material lambert(const char* name, const glm::vec3& albedo);
[[nodiscard]] Material metal(const char* name, const glm::vec3& reflectance, float roughness);
[[nodiscard]] Material mirror(const char* name, const glm::vec3& reflectance);
[[nodiscard]] Material glass(const char* name, const glm::vec3& tint, float ior);
[[nodiscard]] Material lamp(const char* name, const glm::vec3& radiance);

}  // namespace claray::scenes
