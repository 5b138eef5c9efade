// The options of all commands that build a tree.
#pragma once

#include <CLI/CLI.hpp>

#include "claray/bvh.hpp"

namespace claray::cli {

/// --builder, --layout and --morton-bits.
void add_bvh_options(CLI::App& command, Bvh::Config& config);

}  // namespace claray::cli
