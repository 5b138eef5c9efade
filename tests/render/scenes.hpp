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

/// A square of the material in a sphere of lamps of radiance 1, which is not round its middle.
[[nodiscard]] Scene among_lamps(const Material& material);

/// Mean over all pixels.
[[nodiscard]] glm::dvec3 mean(const std::vector<glm::vec3>& image);
/// The mean of red of each column.
[[nodiscard]] std::vector<double> column_means(const std::vector<glm::vec3>& image, unsigned width);
/// Schlick's approximation of Fresnel's reflectance, from that at normal incidence.
[[nodiscard]] double schlick(double f0, double cosine);
[[nodiscard]] bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b);
/// Renders to the end, by the kernels that know every effect unless `config` says otherwise: they are compiled once for
/// all tests. Effects.OwnKernelsMakeTheSameImage shows that the scene's own kernels change no bit.
[[nodiscard]] std::vector<glm::vec3> render_image(const Scene& scene, RenderConfig config);
/// Renders by the scene's own kernels on a device of its own, where light is found by these techniques alone
/// (TECHNIQUES of lights/light.clh).
[[nodiscard]] std::vector<glm::vec3> render_by_techniques(unsigned techniques, const Scene& scene,
                                                          const RenderConfig& config);
/// The same by the kernels of the scene's own effects.
[[nodiscard]] std::vector<glm::vec3> render_by_own_kernels(const Scene& scene, const RenderConfig& config);

}  // namespace claray::test
