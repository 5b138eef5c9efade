// Spectra of scene files as colours: sums over the CIE's curves of 1931, and what metals and glasses are.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string_view>

namespace claray {

/// One sample of a spectrum, between which it is linear.
struct SpectrumSample {
    double wavelength = 0;  ///< nanometres
    double value = 0;
};

/// Linear Rec. 709 of a reflectance in the light D65: a reflectance of 1 is white. Beyond its samples it is 0. Samples
/// are sorted by wavelength.
[[nodiscard]] glm::vec3 rgb_of_reflectance(std::span<const SpectrumSample> samples);
/// Of light. Its luminance is 1 if all values are 1, which is slightly red, since white is D65.
[[nodiscard]] glm::vec3 rgb_of_light(std::span<const SpectrumSample> samples);
/// Of a black body at so many kelvin (Planck's law), with a luminance of 1.
[[nodiscard]] glm::vec3 rgb_of_blackbody(double kelvin);
[[nodiscard]] float luminance_of(const glm::vec3& rgb);

/// Index of refraction and extinction of a conductor, for red, green and blue.
struct Conductor {
    glm::vec3 eta{0.f}, k{1.f};
};
/// "Au", "metal-Au-eta": the element or compound, as pbrt and Mitsuba name it. Nothing for an unknown one.
[[nodiscard]] std::optional<Conductor> conductor_named(std::string_view name);
/// "bk7", "water", "glass-BK7": index of refraction at 589 nm. Nothing for an unknown one.
[[nodiscard]] std::optional<float> ior_named(std::string_view name);

/// Fresnel's equations for unpolarised light that meets a conductor at this cosine (Born and Wolf, section 14.2).
[[nodiscard]] double conductor_reflectance(double eta, double k, double cosine);
/// The reflectance at normal incidence by which Schlick's approximation reflects as much diffuse light as the
/// conductor.
[[nodiscard]] glm::vec3 schlick_color(const Conductor& conductor);

/// Share of diffuse light within a body of index `ior` that its smooth border reflects.
[[nodiscard]] double inner_reflectance(double ior);

}  // namespace claray
