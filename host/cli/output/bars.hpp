// Horizontal bar charts as SVG files that need nothing else.
#pragma once

#include <string>
#include <vector>

namespace claray::cli {

struct Bar {
    std::string label;
    double value = 0;
    bool strong = true;  ///< drawn full; others pale
    bool noise = false;  ///< the value can't be told from 0: no bar is drawn
};

struct BarChart {
    std::string title, subtitle;
    std::string strong, weak;  ///< what the two kinds of bars are
    std::vector<Bar> bars;
};

[[nodiscard]] std::string svg_of(const BarChart& chart);

}  // namespace claray::cli
