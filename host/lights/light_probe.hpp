// Estimates how much light there is where a camera looks, before any kernel is compiled.
#pragma once

#include "claray/scene.hpp"

namespace claray {

/// Shares, 0 to 1, estimated by rays of the host.
struct LightProbe {
    std::size_t lights = 0;  ///< emissive triangles and lights without extent
    double seen = 0;         ///< of the view: shows a surface
    double lit = 0;          ///< of what is seen: grey would be visible there by the scene's lights, lamps among them
    double visible = 0;      ///< of what is seen: lit, or emits visible light itself
    double open = 0;         ///< of what is seen: light from around the scene arrives there
};

/// The least luminance that counts as visible: at exposure 0 a PNG shows it as a tenth of white.
inline constexpr double visible_luminance = 0.02;

/// The scene must be valid (see `validate`). Of light that arrives by way of
/// other surfaces, the first bounce off grey ones counts. Sky and environment are ignored.
[[nodiscard]] LightProbe probe_light(const Scene& scene, const Camera& camera, float aspect);

}  // namespace claray
