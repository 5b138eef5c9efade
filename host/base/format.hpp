// Numbers as text, in the formats of the C library.
#pragma once

#include <cstdio>
#include <string>

namespace claray {

/// std::snprintf into a string of at most 319 characters.
template <class... Values>
[[nodiscard]] std::string printed(const char* format, Values... values) {
    char text[320];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

/// "0.53 s", "2.1 min", "3.4 h", "12 days": three digits.
[[nodiscard]] inline std::string duration_text(double seconds) {
    if (seconds < 1e-3) return printed("%.3g us", 1e6 * seconds);
    if (seconds < 0.1) return printed("%.3g ms", 1e3 * seconds);
    if (seconds < 120) return printed("%.3g s", seconds);
    if (seconds < 7200) return printed("%.3g min", seconds / 60);
    if (seconds < 172'800) return printed("%.3g h", seconds / 3600);
    return printed("%.4g days", seconds / 86'400);
}

}  // namespace claray
