#include "host/bench/names.hpp"
#include "host/cli/commands.hpp"

namespace claray::cli {

void add_bvh_options(CLI::App& command, Bvh::Config& config) {
    command.add_option("--morton-bits", config.morton_bits, "Bits of a Morton code: 30 or 63 [63]")
        ->check(CLI::IsMember({30, 63}));
    command
        .add_option("--builder", config.builder,
                    "How the tree is built: fast, balanced (better, slower) or high (best, slowest) [fast]")
        ->transform(CLI::CheckedTransformer(bench::builders, CLI::ignore_case).description(""))
        ->type_name("NAME");
    command.add_option("--layout", config.layout, "Tree that is traversed: auto, binary or wide [auto]")
        ->transform(CLI::CheckedTransformer(bench::layouts, CLI::ignore_case).description(""))
        ->type_name("NAME");
}

}  // namespace claray::cli
