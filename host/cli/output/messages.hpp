// What the program says on standard error: one line each.
#pragma once

#include <string>

#include "claray/error.hpp"

namespace claray::cli {

void print_warning(const std::string& text);

/// Prints the first line of `text`. A report of a device or a compiler that follows goes to a new file, which the line
/// names. Returns the exit code.
int print_error(ErrorKind kind, const std::string& text);

}  // namespace claray::cli
