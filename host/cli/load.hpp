// Scenes as commands load them: warnings are printed, and what would show nothing is refused.
#pragma once

#include "claray/io.hpp"
#include "host/cli/light_options.hpp"

namespace claray::cli {

/// To stderr, each line once, however many frames it is true of.
void print_warnings(const Warnings& warnings);

/// Throws ErrorKind::user where a scene has triangles and none of them can be seen: all have no area or are not finite.
void refuse_unseen(const std::string& name, const Scene& scene);

/// Options that choose among what a file holds: all but the camera.
void add_load_options(CLI::App& command, LoadOptions& options);

/// Loads a scene, with lights of the command line.
[[nodiscard]] Scene load(const std::string& name, const LightOptions& lights, const LoadOptions& options);

}  // namespace claray::cli
