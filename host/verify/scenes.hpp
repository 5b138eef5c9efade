// Small scenes to verify renders with.
#pragma once

#include "claray/renderer.hpp"
#include "host/verify/run.hpp"

namespace claray::verify {

/// Renders to the end, and ends the case by an error if samples were not finite: the film would leave them out in silence.
void render(Renderer& renderer);
[[nodiscard]] std::vector<glm::vec3> render(const Run& run, const Scene& scene, const RenderConfig& config);
/// All AOVs but the work of the traversal, which depends on the layout of the tree.
[[nodiscard]] std::vector<float> numbers_of(const Aovs& aovs);
/// The mean of red over all pixels.
[[nodiscard]] double mean_of(const std::vector<glm::vec3>& image);
[[nodiscard]] Material grey(float albedo, float radiance = 0.f);
/// A square in the plane of height y, that faces +y, with texture coordinates.
[[nodiscard]] Mesh square(float half, float y, std::uint32_t material);
/// A camera whose pixels are nearly one ray.
[[nodiscard]] Camera narrow_camera(const glm::vec3& position, const glm::vec3& target);

/// One kernel follows whole paths, as GPUs render many scenes.
[[nodiscard]] Form whole_paths();
/// One kernel follows the last paths of a batch, as on GPUs.
[[nodiscard]] Form last_paths();

}  // namespace claray::verify
