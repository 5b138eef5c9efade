// The subcommands of the program `claray`: one function and one file each.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "claray/device.hpp"

namespace claray::cli {

/// The work of the command line: set while it is parsed, run afterwards.
using Action = std::function<void()>;

using AddCommand = void(CLI::App& app, Action& action);
AddCommand add_devices_command, add_scenes_command, add_render_command, add_explain_command, add_compile_command,
    add_bake_command, add_build_command, add_bench_command, add_tune_command, add_verify_command, add_accuracy_command,
    add_view_command, add_probe_command, add_normal_map_command;

/// Opens the device of a command. Prints the warnings about the user's tuning tables.
[[nodiscard]] Device open_device(const std::string& selector = {});
/// The same for several devices: see Device::open_several.
[[nodiscard]] std::vector<Device> open_devices(const std::string& selectors);

}  // namespace claray::cli
