// Small scenes with known answers.
#pragma once

#include "claray/renderer.hpp"

namespace claray::test {

[[nodiscard]] Material lambert(float albedo);
[[nodiscard]] Material emitter(float radiance);
[[nodiscard]] Material material(MaterialKind kind, float albedo, float roughness = 0.f);

/// A square of side 2 * half with the normal (0, 1, 0), at height y.
[[nodiscard]] Mesh square(float half, float y, std::uint32_t material = 0);

/// A camera with a field of view so narrow that the image shows one point.
[[nodiscard]] Camera narrow_camera(glm::vec3 position, glm::vec3 target);

/// Mean over all pixels.
[[nodiscard]] glm::dvec3 mean(const std::vector<glm::vec3>& image);
[[nodiscard]] bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b);
/// Renders to the end.
[[nodiscard]] std::vector<glm::vec3> render_image(const Scene& scene, const RenderConfig& config);

}  // namespace claray::test
