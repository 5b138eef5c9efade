#include "host/cli/options/compile_options.hpp"

#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"

namespace claray::cli {
namespace {

/// What renders pass on, which no other command has as an option.
void add_hidden_options(CLI::App& command, CompileOptions& options) {
    Bvh::Config& bvh = options.config.bvh;
    command.add_option("--leaf-triangles", bvh.max_leaf_triangles)->transform(whole_number(1, 4))->group("");
    command.add_option("--split-budget", bvh.split_budget)->group("");
    const std::vector<std::pair<std::string, Sampler>> samplers = {{"sobol", Sampler::sobol},
                                                                   {"independent", Sampler::independent}};
    command.add_option("--sampler", options.config.sampler)->transform(choice_of(samplers))->group("");
    command.add_flag("--background", options.background)->group("");
    command.add_flag("--serve", options.serves)->group("");
}

}  // namespace

void add_compile_options(CLI::App& command, CompileOptions& options) {
    command.add_option("--effects", options.effects, "Effects that the kernels support: NAME,NAME... [all]");
    command.add_option("--device", options.device, "cpu, gpu, an index or part of a name (see claray devices)");
    add_bvh_options(command, options.config.bvh);
    add_approximate_option(command, options.config.approximate);
    command.add_flag("-q,--quiet", options.quiet, "Print nothing");
    add_hidden_options(command, options);
}

}  // namespace claray::cli
