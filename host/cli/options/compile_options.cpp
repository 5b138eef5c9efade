#include "host/cli/options/compile_options.hpp"

#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/render_options.hpp"

namespace claray::cli {

void add_compile_options(CLI::App& command, CompileOptions& options) {
    command.add_option("--effects", options.effects, "Effects that the kernels support: NAME,NAME... [all]");
    command.add_option("--device", options.device, "cpu, gpu, an index or part of a name (see claray devices)");
    add_bvh_options(command, options.config.bvh);
    add_approximate_option(command, options.config.approximate);
    command.add_flag("-q,--quiet", options.quiet, "Print nothing");
    // Of claray's own processes.
    command.add_flag("--background", options.background)->group("");
    command.add_flag("--serve", options.serves)->group("");
}

}  // namespace claray::cli
