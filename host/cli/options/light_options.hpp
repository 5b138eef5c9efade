// --light, --sky, --fog and --environment of `claray render`.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "claray/io.hpp"

namespace claray::cli {

struct LightOptions {
    std::vector<Light> lights;
    bool artist_lights = false;
    std::optional<Sky> sky;
    std::optional<Sky> fog;  // of which only the fog counts
    std::filesystem::path environment;
    std::optional<float> strength, rotation;  // rotation in degrees
};

void add_light_options(CLI::App& command, LightOptions& options);
/// Adds the lights to the scene's own; sky, fog and environment replace its own. Returns false if no light is given.
bool add_lights(Scene& scene, const LightOptions& options);

}  // namespace claray::cli
