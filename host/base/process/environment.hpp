// Environment variables.
#pragma once

#include <cstdlib>
#include <string>

namespace claray {

/// The value of a variable; empty if it is not set.
[[nodiscard]] inline std::string environment(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : "";
}

}  // namespace claray
