// --light, --sky, --fog, --studio and --environment of `claray render`.
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
    std::optional<Sky> fog;           // of which only the fog counts
    std::optional<glm::vec3> studio;  // the direction of the view
    std::filesystem::path environment;
    std::optional<float> strength, rotation;  // rotation in degrees
};

void add_light_options(CLI::App& command, LightOptions& options);
/// Adds the lights to the scene's own; sky, fog and environment replace its own. Returns false if no light is given.
bool add_lights(Scene& scene, const LightOptions& options);
/// Replaces the environment by the studio for the scene's camera, if there is one.
void add_studio(Scene& scene, const LightOptions& options);

}  // namespace claray::cli
