// Scenes as commands load them: warnings are printed, and what would show nothing is refused.
#pragma once

#include <functional>
#include <optional>

#include "claray/io.hpp"
#include "host/cli/options/light_options.hpp"

namespace claray::cli {

/// To stderr, each line once, however many frames it is true of.
void print_warnings(const Warnings& warnings);

/// Throws ErrorKind::user where a scene has triangles and none of them can be seen: all have no area or are not finite.
void refuse_unseen(const std::string& name, const Scene& scene);

/// --cull and --front: which sides of a file's surfaces exist, and which of them is the front.
struct SurfaceOptions {
    int culling = int(Culling::by_file);
    bool clockwise_front = false;
};
void add_surface_options(CLI::App& command, SurfaceOptions& options);

using ChooseCamera = std::function<Camera(const Scene&)>;

/// Options that choose among what a file holds: all but the camera.
void add_load_options(CLI::App& command, LoadOptions& options);

/// Loads a scene, with lights and sides of surfaces of the command line. Without any, a file that would be dark is lit
/// as by `load_scene`. `choose` sets its camera; without that it stays as it is. `default_light`: what all frames of an
/// animation are lit by where the file is dark; the first one fills it in.
[[nodiscard]] Scene load(const std::string& name, const LoadOptions& options, const LightOptions& lights,
                         const SurfaceOptions& surfaces, const ChooseCamera& choose = {}, float aspect = 1.f,
                         std::optional<LightOptions>* default_light = nullptr);

}  // namespace claray::cli
