#include "host/cli/output/bars.hpp"

#include <algorithm>
#include <cmath>

#include "host/accuracy/svg.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

constexpr double width = 760, label_width = 170, value_width = 80, top = 92, pitch = 26, thickness = 16;
constexpr const char *strong_color = "#2a6f97", *weak_color = "#b8c4cc", *ink = "#222", *pale_ink = "#666";

using svg::rectangle;
using svg::text;

}  // namespace

std::string svg_of(const BarChart& chart) {
    double lowest = 0, highest = 0;
    for (const Bar& bar : chart.bars)
        if (!bar.noise) lowest = std::min(lowest, bar.value), highest = std::max(highest, bar.value);
    const double height = top + pitch * double(chart.bars.size()) + 14;
    // Room for the numbers: right of positive bars, left of negative ones.
    const double left = label_width + (lowest < 0 ? value_width : 12), right = width - value_width;
    const double scale = highest > lowest ? (right - left) / (highest - lowest) : 0, zero = left - lowest * scale;
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + fixed(width, 0) + " " +
                      fixed(height, 0) + "\" width=\"" + fixed(width, 0) + "\" height=\"" + fixed(height, 0) +
                      "\" font-family=\"sans-serif\">\n" + rectangle(0, 0, width, height, "#fff");
    svg += text(16, 28, "start", 18, ink, chart.title) + text(16, 48, "start", 12, pale_ink, chart.subtitle);
    svg += rectangle(16, 62, 12, 12, strong_color) + text(34, 72, "start", 12, ink, chart.strong);
    svg += rectangle(256, 62, 12, 12, weak_color) + text(274, 72, "start", 12, ink, chart.weak);
    double y = top;
    for (const Bar& bar : chart.bars) {
        const double value = bar.noise ? 0 : bar.value, length = std::abs(value) * scale, end = zero + value * scale;
        const double baseline = y + 0.5 * thickness + 4;
        svg += text(label_width, baseline, "end", 12, ink, bar.label);
        svg +=
            rectangle(std::min(zero, end), y, std::max(length, 1.0), thickness, bar.strong ? strong_color : weak_color);
        svg += text(value < 0 ? end - 5 : end + 5, baseline, value < 0 ? "end" : "start", 12, pale_ink,
                    bar.noise ? "noise" : fixed(value, 3));
        y += pitch;
    }
    svg += rectangle(zero, top - 4, 1, pitch * double(chart.bars.size()), ink);
    return svg + "</svg>\n";
}

}  // namespace claray::cli
