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

}  // namespace claray
