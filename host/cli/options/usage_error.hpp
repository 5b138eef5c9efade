// What is wrong with a command line, in words of our own instead of the parser's.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace claray::cli {

/// One line: what, where and what to do. `app` is what threw `error` when it parsed these arguments.
[[nodiscard]] std::string usage_error(const CLI::App& app, int argc, char** argv, const CLI::ParseError& error);

/// Throws ErrorKind::usage where an option of the command that was called is given with nothing for its value, as a
/// variable of a script does that is not set.
void refuse_empty_values(const CLI::App& app);

}  // namespace claray::cli
