// Lenses and exposure as photographers tell them.
#pragma once

#include <CLI/CLI.hpp>

#include "host/cli/options/render_options.hpp"

namespace claray::cli {

/// --shift, --tilt, --stereo, --eye-distance, --focal-length, --sensor-height, --f-number
void add_lens_options(CLI::App& command, LensOptions& options);
/// The camera with them.
[[nodiscard]] Camera with_lens(Camera camera, const LensOptions& options);

/// --iso and --shutter-time, which need --f-number
void add_exposure_options(CLI::App& command, RenderOptions& options);
/// Sets the exposure by them. Throws ErrorKind::usage for options that exclude each other.
void check_exposure_options(const CLI::App& command, RenderOptions& options);

/// Stops for an image in cd/m^2, so that what saturates a sensor of this speed becomes 1. The luminance that saturates
/// is 78 N^2 / (q S t) with q = 0.65 (ISO 12232, saturation-based speed; Lagarde and de Rousiers 2014, "Moving
/// Frostbite to physically based rendering", section 5.1).
[[nodiscard]] double stops_of(double iso, double f_number, double shutter_seconds);

}  // namespace claray::cli
