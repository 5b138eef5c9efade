// Lights files that contain no light, or hardly any.
#pragma once

#include <optional>
#include <string>

#include "claray/io.hpp"

namespace claray {

struct LoadedScene {
    Scene scene;
    bool is_file = false;  ///< built-in scenes need no default light
};

/// As `load_scene`, `load_obj` and `load_gltf`, but these add no light to dark scenes: call `light_if_dark` afterwards.
[[nodiscard]] LoadedScene load_without_light(const std::string& name_or_path, Warnings& warnings,
                                             const LoadOptions& options);
[[nodiscard]] Scene load_obj_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_ply_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_stl_without_light(const std::filesystem::path& path, Warnings& warnings);
[[nodiscard]] Scene load_gltf_without_light(const std::filesystem::path& path, Warnings& warnings,
                                            const LoadOptions& options);
[[nodiscard]] std::optional<double> gltf_animation_seconds(const std::filesystem::path& path,
                                                           const LoadOptions& options);

/// Lights a scene in which `camera` would see hardly anything by the scene's own lights: by a pale sky or, if no sky
/// light reaches the view, by a lamp at the camera. Returns a line for the user; empty if the scene is unchanged.
[[nodiscard]] std::optional<std::string> light_if_dark(Scene& scene, const Camera& camera, float aspect);
/// As the scene's own camera sees it, else the automatic one.
[[nodiscard]] std::optional<std::string> light_if_dark(Scene& scene);

}  // namespace claray
