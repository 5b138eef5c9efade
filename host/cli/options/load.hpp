// Loads scenes for commands: prints warnings, refuses scenes without visible triangles.
#pragma once

#include <functional>
#include <optional>

#include "claray/io.hpp"
#include "host/cli/options/light_options.hpp"
#include "host/io/default_light.hpp"

namespace claray::cli {

/// Prints each line to stderr once, even if several frames cause it.
void print_warnings(const Warnings& warnings);

/// --cull and --front: which sides of a file's surfaces exist, and which of them is the front. --alpha-test and
/// --texture-filter replace those of all materials and textures.
struct SurfaceOptions {
    int culling = int(Culling::by_file);
    bool clockwise_front = false;
    std::optional<int> alpha_test, texture_filter;
};
void add_surface_options(CLI::App& command, SurfaceOptions& options);

/// How `load` finds the camera of a scene.
struct ViewChoice {
    std::function<Camera(const Scene&)> camera = {};  ///< replaces the scene's
    std::optional<float> inside = {};  ///< field of view of a camera that may replace it, inside of rooms
    float aspect = 1.f;
    bool exposes = false;  ///< the caller takes the exposure of a light that is chosen
};

/// Options that select parts of a file: all but the camera.
void add_load_options(CLI::App& command, LoadOptions& options);

/// Loads a scene, with lights and sides of surfaces of the command line. A file that shows nothing gets light and a
/// view as by `load_scene`. `default_light` is the light of all frames of an animation whose file is dark; the first
/// frame sets it. Throws ErrorKind::user if the scene has triangles but none can be seen.
[[nodiscard]] Scene load(const std::string& name, const LoadOptions& options, const LightOptions& lights,
                         const SurfaceOptions& surfaces, const ViewChoice& view = {},
                         std::optional<DefaultLight>* default_light = nullptr);

}  // namespace claray::cli
