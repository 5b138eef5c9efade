// claray compile: compiles kernels in advance.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <thread>

#include "claray/renderer.hpp"
#include "host/base/seconds_since.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/compile_options.hpp"
#include "host/compute/programs/compiler_processes.hpp"
#include "host/render/kernels/background_compiler.hpp"

namespace claray::cli {
namespace {

/// Ends this process in the middle of its work, which a driver cannot interrupt. Both caches only get whole files.
void end_when_told(const std::shared_ptr<CompilerWatch>& watch) {
    std::thread([watch, begin = std::chrono::steady_clock::now()] {
        while (!watch->must_end(seconds_since(begin))) std::this_thread::sleep_for(std::chrono::milliseconds(200));
        ::_exit(0);
    }).detach();
}

/// The kernels of a render, then those that can wait.
void compile_in_background(const CompileOptions& options) {
    const auto watch = std::make_shared<CompilerWatch>();
    end_when_told(watch);
    const Device device = Device::open(options.device);
    load(device, read_kernel_set(std::cin));
    watch->let_others_compile();
    load(device, read_kernel_set(std::cin));
}

void compile(const CompileOptions& options) {
    if (options.background) return compile_in_background(options);
    const Device device = Device::open(options.device);
    if (options.serves) return serve_as_compiler(device);
    const EffectSet effects = options.effects.empty() ? full_effects() : parse_effects(options.effects);
    compile_kernels(device, effects, options.config);
    const CompileStatistics statistics = compile_statistics();
    if (!options.quiet)
        std::printf("%s: %u compiled, %u from the cache, %.1f s\n", to_string(effects).c_str(), statistics.compiled,
                    statistics.from_cache, statistics.milliseconds * 1e-3);
}

}  // namespace

void add_compile_command(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("compile", "Compile kernels in advance, so that the first image starts without delay");
    command->footer(
        "Without --effects: compile the generic kernels, with which renders of new scenes start. claray render also "
        "does\n"
        "this automatically in the background.");
    auto options = std::make_shared<CompileOptions>();
    add_compile_options(*command, *options);
    command->callback([&action, options] { action = [options] { compile(*options); }; });
}

}  // namespace claray::cli
