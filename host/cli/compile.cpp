// claray compile: compiles kernels in advance.
#include <cstdio>
#include <memory>

#include "claray/renderer.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/compute/programs/compiler_processes.hpp"
#include "host/render/kernels/background_compiler.hpp"

namespace claray::cli {
namespace {

struct CompileOptions {
    std::string device, effects;
    RenderConfig config;
    bool quiet = false, and_generic = false, serves = false;
};

void compile(const CompileOptions& options) {
    const Device device = Device::open(options.device);
    if (options.serves) return serve_as_compiler(device);
    const EffectSet effects = options.effects.empty() ? full_effects() : parse_effects(options.effects);
    compile_kernels(device, effects, options.config);
    if (options.and_generic) {
        let_others_compile();
        compile_kernels(device, full_effects(), options.config);
    }
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
    command->add_option("--effects", options->effects, "Effects that the kernels support: NAME,NAME... [all]");
    command->add_option("--device", options->device, "cpu, gpu, an index or part of a name (see claray devices)");
    add_bvh_options(*command, options->config.bvh);
    add_approximate_option(*command, options->config.approximate);
    command->add_flag("--and-generic", options->and_generic, "Also compile the generic kernels afterwards");
    command->add_flag("--serve", options->serves)->group("");  // for other processes of this program
    command->add_flag("-q,--quiet", options->quiet, "Print nothing");
    command->callback([&action, options] { action = [options] { compile(*options); }; });
}

}  // namespace claray::cli
