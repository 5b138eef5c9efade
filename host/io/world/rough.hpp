// What single scattering by facets does with diffuse light. pbrt and Mitsuba lose the light that facets scatter more
// than once, and claray does not: readers darken colours by these shares, so that surfaces are as bright as in these
// programs.
#pragma once

namespace claray {

/// How facets are tilted: by GGX, or by Beckmann's distribution.
struct Facets {
    double alpha = 0;
    bool beckmann = false;
};

/// The alpha of GGX over that of Beckmann's lobe, if half of the facets of both are as steep: 1 - exp(-t^2) of
/// Beckmann's and t^2 / (t^2 + 1) of GGX have slopes below t alpha (Walter et al. 2007).
inline constexpr float ggx_of_beckmann = 0.832555f;  // sqrt(ln 2)
/// The facets of claray that show these.
[[nodiscard]] inline Facets shown(const Facets& facets) {
    return {facets.beckmann ? facets.alpha * double(ggx_of_beckmann) : facets.alpha};
}

/// Shares of diffuse light that a rough border between two dielectrics reflects and passes at its first scattering; the
/// rest meets another facet. Smith's masking of both directions apart (Walter et al. 2007).
struct RoughBorder {
    double reflected = 0, passed = 1;
};
/// `ior`: index behind the border over that before it.
[[nodiscard]] RoughBorder rough_border(double ior, const Facets& facets);
/// The share of facets that reflect everything: 1 where they are smooth.
[[nodiscard]] double kept_by_facets(const Facets& facets);

/// The reflectance by which facets that lose nothing reflect as much as those of `reflectance` at their first
/// scattering: F' E / (1 - F' (1 - E)) = F E.
[[nodiscard]] inline float darkened_metal(float reflectance, double kept) {
    return float(reflectance / (1 + reflectance * (1 - kept)));
}
/// The albedo of Burley's diffuse lobe over its colour, of diffuse light (Burley 2015, "Extending the Disney BRDF to a
/// BSDF with integrated subsurface scattering", section 4).
[[nodiscard]] double burley_diffuse(double roughness);

/// A diffuse base under a rough border, once for all its colours.
class RoughBase {
public:
    /// `tinted`: the base's colour tints the light between base and border.
    RoughBase(double ior, const Facets& facets, bool tinted);
    /// The albedo of a base of claray that returns as much diffuse light.
    [[nodiscard]] float albedo(float of_file) const;

private:
    double returned_ = 1;  ///< of the light that enters claray's base, without interreflection
    double inner_ = 0;     ///< share that the border sends back into the base
    bool tinted_ = false;
};

}  // namespace claray
