// The subcommands of the program `claray`: one function and one file each.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "claray/bvh.hpp"

namespace claray::cli {

/// What the command line asks for; set while it is parsed, run afterwards.
using Action = std::function<void()>;

void add_devices_command(CLI::App& app, Action& action);
void add_scenes_command(CLI::App& app, Action& action);
void add_render_command(CLI::App& app, Action& action);
void add_explain_command(CLI::App& app, Action& action);
void add_compile_command(CLI::App& app, Action& action);
void add_bench_command(CLI::App& app, Action& action);
void add_tune_command(CLI::App& app, Action& action);
void add_build_command(CLI::App& app, Action& action);
void add_bake_command(CLI::App& app, Action& action);
void add_verify_command(CLI::App& app, Action& action);
void add_accuracy_command(CLI::App& app, Action& action);

/// --builder, --layout and --morton-bits, for the commands that build a tree.
void add_bvh_options(CLI::App& command, Bvh::Config& config);

}  // namespace claray::cli
