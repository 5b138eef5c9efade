// Light for files that bring none, or hardly any.
#pragma once

#include <optional>
#include <string>

#include "claray/io.hpp"

namespace claray {

struct LoadedScene {
    Scene scene;
    bool is_file = false;  ///< built-in scenes are lit as they should be
};

/// As `load_scene`, `load_obj` and `load_gltf`, which then light what is dark.
[[nodiscard]] LoadedScene load_without_light(const std::string& name_or_path, Warnings& warnings,
                                             const LoadOptions& options);
[[nodiscard]] Scene load_obj_without_light(const std::filesystem::path& path, Warnings& warnings);
[[nodiscard]] Scene load_gltf_without_light(const std::filesystem::path& path, Warnings& warnings,
                                            const LoadOptions& options);

/// Lights a scene of which `camera` would see hardly anything by its own lights: by a pale sky or, where no sky reaches
/// what is in view, by a lamp at the camera. Returns a line that tells the user, nothing where the scene stays as it
/// is.
[[nodiscard]] std::optional<std::string> light_if_dark(Scene& scene, const Camera& camera, float aspect);

}  // namespace claray
