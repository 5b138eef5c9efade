// The options of `claray render` as the command line and --help have them.
#pragma once

#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"

namespace claray::cli {

/// Adds all options. `options` must live until they are parsed.
void add_render_options(CLI::App& command, RenderOptions& options);

/// Called after parsing: throws ErrorKind::usage for options that exclude or need each other.
void check_render_options(const CLI::App& command);

}  // namespace claray::cli
