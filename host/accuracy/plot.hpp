// Work-precision plots: error across, seconds upwards, both logarithmic; SVG that needs nothing else.
#pragma once

#include <string>

#include "claray/accuracy.hpp"

namespace claray {

/// `subtitle` tells scene, device, driver and date. Points that failed are gaps; those on the front are filled.
[[nodiscard]] std::string svg_of(const Study& study, const std::string& subtitle);

/// A page with every study's plot, table and findings.
[[nodiscard]] std::string html_of(const std::vector<Study>& studies, const std::string& title,
                                  const std::string& subtitle);

/// A row a point.
[[nodiscard]] std::string csv_of(const std::vector<Study>& studies, const std::string& device,
                                 const std::string& driver, const std::string& scene);

}  // namespace claray
