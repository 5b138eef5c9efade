// Pieces of SVG and HTML, for plots, charts and reports.
#pragma once

#include <string>

#include "host/base/format.hpp"

namespace claray::svg {

/// As text between tags.
[[nodiscard]] inline std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

/// `anchor` is start, middle or end; `more` are further attributes.
[[nodiscard]] inline std::string text(double x, double y, const char* anchor, double size, const char* color,
                                      const std::string& words, const std::string& more = {}) {
    return "<text x=\"" + printed("%.1f", x) + "\" y=\"" + printed("%.1f", y) + "\" text-anchor=\"" + anchor +
           "\" font-size=\"" + printed("%.0f", size) + "\" fill=\"" + color + "\"" + more + ">" + escaped(words) +
           "</text>\n";
}

[[nodiscard]] inline std::string rectangle(double x, double y, double w, double h, const char* color) {
    return "<rect x=\"" + printed("%.1f", x) + "\" y=\"" + printed("%.1f", y) + "\" width=\"" + printed("%.1f", w) +
           "\" height=\"" + printed("%.1f", h) + "\" fill=\"" + color + "\"/>\n";
}

}  // namespace claray::svg
