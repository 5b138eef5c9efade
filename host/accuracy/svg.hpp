// Pieces of SVG and HTML, for plots, charts and reports.
#pragma once

#include <string>

#include "host/base/format.hpp"
#include "host/base/message.hpp"

namespace claray::svg {

/// `anchor` is start, middle or end; `more` are further attributes.
[[nodiscard]] inline std::string text(double x, double y, const char* anchor, double size, const char* color,
                                      const std::string& words, const std::string& more = {}) {
    return printed("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"%.0f\" fill=\"%s\"", x, y, anchor, size,
                   color) +
           more + ">" + escaped(words) + "</text>\n";
}

[[nodiscard]] inline std::string rectangle(double x, double y, double w, double h, const char* color) {
    return printed("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>\n", x, y, w, h, color);
}

/// The opening tag, and a white background.
[[nodiscard]] inline std::string begin(double width, double height) {
    return printed("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\"",
                   width, height, width, height) +
           " font-family=\"sans-serif\">\n" + rectangle(0, 0, width, height, "#fff");
}

}  // namespace claray::svg
