// What surfaces of scene files look like, as claray's materials.
#pragma once

#include "host/io/world/paint.hpp"
#include "host/io/world/spectrum.hpp"

namespace claray {

struct Look {
    Material material = {};
    bool both_sides = true;  ///< false: the back of an opaque surface is black
    bool invisible = false;  ///< only the border of a medium
};

/// The widths of GGX lobes, or of Beckmann's, along u and v; 0 is smooth.
struct Alphas {
    Paint u{0.f}, v{0.f};
    bool beckmann = false;
};

[[nodiscard]] Look diffuse_look(Paints& paints, const Paint& reflectance);
/// A diffuse base under the border of a dielectric. `tinted`: light that the border sends back into the base is counted
/// with the base's colour (Mitsuba's "nonlinear", and what pbrt's random walk gives).
[[nodiscard]] Look plastic_look(Paints& paints, const Paint& reflectance, float ior, const Alphas& alphas, bool tinted);
/// `color`: reflectance at normal incidence of Schlick's approximation; `tint` multiplies what it is at any angle.
[[nodiscard]] Look metal_look(Paints& paints, const Paint& color, const Alphas& alphas, const Paint& tint = {});
/// Burley's principled BSDF without transmission: `base` is the colour of its metal and of its diffuse lobe.
[[nodiscard]] Look burley_look(Paints& paints, const Paint& base, float metallic, float ior, const Alphas& alphas);
[[nodiscard]] Look glass_look(Paints& paints, float ior, const Alphas& alphas, const Paint& tint);
/// A pane, with all reflections between its sides.
[[nodiscard]] Look pane_look(Paints& paints, float ior, const Paint& tint);
/// The surface exists with this probability.
void set_opacity(Look& look, Paints& paints, const Paint& opacity);
/// Both looks by their parameters: exactly a mixture of a diffuse surface, metal and glass of equal roughness.
[[nodiscard]] Look mixed_look(Paints& paints, const Look& a, const Look& b, const Paint& amount);
[[nodiscard]] Look grey_look();

void set_albedo(Material& material, Paints& paints, const Paint& paint);
/// Sets roughness = sqrt(alpha), and stretches the lobe if the alphas differ, which needs a principled material.
void set_roughness(Material& material, Paints& paints, const Alphas& alphas);

}  // namespace claray
