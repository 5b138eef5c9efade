#include "host/cli/options/bvh_options.hpp"

#include "host/cli/options/option_rules.hpp"
#include "host/measure/names.hpp"

namespace claray::cli {
namespace {

/// "fast (fastest to build), balanced (...)".
std::string builders_with_notes() {
    std::string text;
    for (const BuilderTraits& traits : builders) text += std::string(traits.name) + " (" + traits.note + "), ";
    return text + automatic_traits.name + " (" + automatic_traits.note + ')';
}

}  // namespace

void add_bvh_options(CLI::App& command, Bvh::Config& config) {
    command.add_option("--morton-bits", config.morton_bits, "Bits per Morton code: 30 or 63 [63]")
        ->check(name_among({"30", "63"}));
    command
        .add_option("--builder", config.builder,
                    "Builder of the tree: " + builders_with_notes() + " [" + traits_of(config.builder).name + "]")
        ->transform(choice_of(measure::builders_and_automatic()))
        ->type_name("NAME");
    command
        .add_option("--layout", config.layout, "Layout of the tree for tracing: automatic, binary or wide [automatic]")
        ->transform(choice_of(measure::layouts))
        ->type_name("NAME");
}

}  // namespace claray::cli
