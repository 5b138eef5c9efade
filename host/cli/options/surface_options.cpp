#include "host/cli/options/surface_options.hpp"

#include "host/cli/options/option_rules.hpp"

namespace claray::cli {

void add_surface_options(CLI::App& command, SurfaceOptions& o) {
    command
        .add_option("--cull", o.culling,
                    "Sides of surfaces to leave out: back, none, or file (as in the materials) [file]")
        ->transform(choice_of<Culling>({{"file", Culling::by_file}, {"back", Culling::back}, {"none", Culling::none}}))
        ->type_name("NAME");
    command
        .add_option("--front", o.clockwise_front,
                    "Order of the vertices of a front: ccw (counter-clockwise) or cw [ccw]")
        ->transform(choice_of({{"ccw", 0}, {"cw", 1}}))
        ->type_name("NAME");
}

void apply(const SurfaceOptions& options, Scene& scene) {
    if (options.clockwise_front) flip_fronts(scene);
    set_culling(scene, Culling(options.culling));
}

}  // namespace claray::cli
