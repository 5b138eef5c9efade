// --cull and --front: which sides of a file's surfaces are there, and which of them is the front.
#pragma once

#include <CLI/CLI.hpp>

#include "claray/io.hpp"

namespace claray::cli {

struct SurfaceOptions {
    int culling = int(Culling::by_file);
    bool clockwise_front = false;
};

void add_surface_options(CLI::App& command, SurfaceOptions& options);
void apply(const SurfaceOptions& options, Scene& scene);

}  // namespace claray::cli
