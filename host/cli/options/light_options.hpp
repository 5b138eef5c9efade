// --light, --sky and --environment of `claray render`.
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
    std::optional<Sky> sky;
    std::filesystem::path environment;
    std::optional<float> strength, rotation;  // rotation in degrees
};

/// "spot,position=0,2,0,direction=0,-1,0,intensity=50,inner=20,outer=30": a kind (point, directional, spot), then names
/// and values; angles in degrees, one number for three equal ones. Throws ErrorKind::usage.
[[nodiscard]] Light parse_light(const std::string& text);
/// "R,G,B", or "R,G,B,R,G,B" from the horizon to the zenith; one number is grey. Throws ErrorKind::usage.
[[nodiscard]] Sky parse_sky(const std::string& text);

void add_light_options(CLI::App& command, LightOptions& options);
/// Adds the lights to the scene's own, sky and environment replace its own. False where no light is given.
bool add_lights(Scene& scene, const LightOptions& options);

}  // namespace claray::cli
