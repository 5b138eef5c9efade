// Numbers as text, in the formats of the C library.
#pragma once

#include <cstdio>
#include <string>

namespace claray {

/// std::snprintf into a string, of 319 characters at most.
template <class... Values>
[[nodiscard]] std::string printed(const char* format, Values... values) {
    char text[320];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

}  // namespace claray
