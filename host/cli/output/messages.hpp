// Messages on standard error, one line each.
#pragma once

#include <string>

#include "claray/error.hpp"

namespace claray::cli {

void print_warning(const std::string& text);

/// Prints the first line of `text`. If more lines follow, as from a compiler, all go to a new file that the line names.
/// Returns the exit code.
int print_error(ErrorKind kind, const std::string& text);

}  // namespace claray::cli
