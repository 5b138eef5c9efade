// Work-precision plots as self-contained SVG: error on the x axis, seconds on the y axis, both logarithmic.
#pragma once

#include <string>

#include "claray/accuracy.hpp"

namespace claray {

/// Whether any point is drawn: some studies find nothing to measure in a scene.
[[nodiscard]] bool has_plot(const Study& study);

/// `subtitle`: scene and date; the study's device follows. Failed points are gaps; points on the front are filled.
[[nodiscard]] std::string svg_of(const Study& study, const std::string& subtitle);

/// A page with every study's plot, table and findings, as far as there are any.
[[nodiscard]] std::string html_of(const std::vector<Study>& studies, const std::string& title,
                                  const std::string& subtitle);

/// A row per point.
[[nodiscard]] std::string csv_of(const std::vector<Study>& studies, const std::string& scene);

}  // namespace claray
