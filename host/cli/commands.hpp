// The subcommands of the program `claray`: one file each, which defines add_NAME_command.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "claray/device.hpp"

namespace claray::cli {

/// The work of the command line: set while it is parsed, run afterwards.
using Action = std::function<void()>;

/// All commands, in the order of the help.
#define CLARAY_COMMANDS(X) \
    X(devices)             \
    X(scenes)              \
    X(info)                \
    X(render)              \
    X(explain)             \
    X(compile)             \
    X(bake)                \
    X(build) X(bench) X(tune) X(verify) X(attest) X(accuracy) X(view) X(probe) X(normal_map) X(completion) X(man)

#define CLARAY_DECLARE(name) void add_##name##_command(CLI::App& app, Action& action);
CLARAY_COMMANDS(CLARAY_DECLARE)
#undef CLARAY_DECLARE

/// Opens the device of a command. Prints warnings about its driver and the user's tuning tables.
[[nodiscard]] Device open_device(const std::string& selector = {});
/// The same for several devices: see Device::open_several.
[[nodiscard]] std::vector<Device> open_devices(const std::string& selectors);

}  // namespace claray::cli
