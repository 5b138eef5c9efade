// What single scattering by facets does with diffuse light. pbrt and Mitsuba lose the light that facets scatter more
// than once, and claray does not: readers darken colours by these shares, so that surfaces are as bright as in these
// programs.
#pragma once

namespace claray {

/// Shares of diffuse light that a rough border between two dielectrics reflects and passes at its first scattering; the
/// rest meets another facet. GGX with Smith's masking of both directions apart (Walter et al. 2007).
struct RoughBorder {
    double reflected = 0, passed = 1;
};
/// `ior`: index behind the border over that before it.
[[nodiscard]] RoughBorder rough_border(double ior, double alpha);
/// The share of facets that reflect everything: 1 where they are smooth.
[[nodiscard]] double kept_by_facets(double alpha);

/// The reflectance by which facets that lose nothing reflect as much as those of `reflectance` at their first
/// scattering: F' E / (1 - F' (1 - E)) = F E.
[[nodiscard]] inline float darkened_metal(float reflectance, double kept) {
    return float(reflectance / (1 + reflectance * (1 - kept)));
}
/// A diffuse base under a rough border, once for all its colours.
class RoughBase {
public:
    /// `tinted`: the base's colour tints the light between base and border.
    RoughBase(double ior, double alpha, bool tinted);
    /// The albedo of a base of claray that returns as much diffuse light.
    [[nodiscard]] float albedo(float of_file) const;

private:
    double returned_ = 1;  ///< of the light that enters claray's base, without interreflection
    double inner_ = 0;     ///< share that the border sends back into the base
    bool tinted_ = false;
};

}  // namespace claray
