// Estimates the light in a camera's view before any kernel is compiled.
#pragma once

#include "claray/scene.hpp"

namespace claray {

/// Shares, 0 to 1, estimated by rays of the host.
struct LightProbe {
    std::size_t lights = 0;  ///< emissive triangles and lights without extent
    double seen = 0;         ///< fraction of the view that shows a surface
    double lit = 0;      ///< fraction of that on which the scene's lights, including lamps, make a grey surface visible
    double visible = 0;  ///< fraction of that which is lit or emits visible light
    double open = 0;     ///< fraction of that which light from around the scene reaches
};

/// The smallest visible luminance: at exposure 0 a PNG shows it as a tenth of white.
inline constexpr double visible_luminance = 0.02;

/// The scene must be valid (see `validate`). Of light that arrives by way of
/// other surfaces, the first bounce off grey ones counts. Sky and environment are ignored.
[[nodiscard]] LightProbe probe_light(const Scene& scene, const Camera& camera, float aspect);

}  // namespace claray
