// Estimates the light in a camera's view before any kernel is compiled.
#pragma once

#include <optional>

#include "claray/scene.hpp"
#include "host/trace/host_rays.hpp"

namespace claray {

/// A scene that the host traces: triangles stand for its primitives. Keeps a reference to the scene.
class ProbedScene {
public:
    /// The scene must be valid (see `validate`).
    ProbedScene(const Scene& scene);  // NOLINT(google-explicit-constructor): a scene is one that can be probed
    [[nodiscard]] const Scene& scene() const { return with_stand_ins_ ? *with_stand_ins_ : scene_; }
    [[nodiscard]] const HostRays& rays() const { return rays_; }

private:
    const Scene& scene_;
    std::optional<Scene> with_stand_ins_;
    HostRays rays_;
};

/// Shares, 0 to 1, estimated by rays of the host.
struct LightProbe {
    std::size_t lights = 0;  ///< emissive triangles and lights without extent
    double seen = 0;         ///< fraction of the view that shows a surface
    double lit = 0;      ///< fraction of that on which the scene's lights, including lamps, make a grey surface visible
    double visible = 0;  ///< fraction of that which is lit or emits visible light
    double open = 0;     ///< fraction of that which light from around the scene reaches
    double plain = 0;    ///< fraction of that whose material emits nothing
    double plain_lit = 0;   ///< fraction of the plain surfaces that are lit
    double brightness = 0;  ///< luminance of grey surfaces there that three quarters of the lit ones do not exceed
    /// Depth of a place behind the one-sided surfaces that the camera looks through, before what it sees; 0: mostly it
    /// looks through none.
    double behind_backs = 0;
};

/// The smallest visible luminance: at exposure 0 a PNG shows it as a tenth of white.
inline constexpr double visible_luminance = 0.02;

/// Of light that arrives by way of other surfaces, the first bounce off grey ones counts. Sky and environment are
/// ignored.
[[nodiscard]] LightProbe probe_light(const ProbedScene& scene, const Camera& camera, float aspect);

/// The log-average (Reinhard et al. 2002, "Photographic tone reproduction for digital images", section 3) of the
/// luminance that the visible surfaces would have if they were white, in light that grey ones reflect, too. `lit` is
/// the scene with the light that counts: its lights, and its sky or its environment, which is one image that is not
/// turned. 0: no light arrives.
[[nodiscard]] double log_average_of_white(const ProbedScene& scene, const Scene& lit, const Camera& camera,
                                          float aspect);

}  // namespace claray
