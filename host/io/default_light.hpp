// Light and views for files that lack them.
#pragma once

#include <optional>
#include <string>

#include "claray/io.hpp"

namespace claray {

struct LoadedScene {
    Scene scene;
    bool is_file = false;  ///< it may need light: neither built in nor of a format that states all light
};

/// As `load_scene`, but it adds no light to dark scenes: call `make_visible` afterwards.
[[nodiscard]] LoadedScene load_without_light(const std::string& name_or_path, Warnings& warnings,
                                             const LoadOptions& options);

/// Light for scenes that have hardly any.
struct DefaultLight {
    std::optional<Sky> sky;
    std::optional<Environment> environment;
    std::optional<Light> lamp;
    /// In stops: of pictures whose exposure is not given. Empty for a lamp, which shows grey as mid-grey.
    std::optional<float> exposure;
};
void add(Scene& scene, const DefaultLight& light);

/// What claray may choose to show a file.
struct MayChoose {
    bool light = true;
    bool view = true;         ///< from inside, if the scene is mostly rooms
    float inside_fov = 60.f;  ///< degrees, vertical, of that view
};

/// What it chose, with a line for the user each; empty if nothing.
struct Chosen {
    std::string view, light;
    bool past_backs = false;  ///< one-sided surfaces keep light from what the camera sees through them
    DefaultLight added;
    [[nodiscard]] std::string line() const { return view + (view.empty() || light.empty() ? "" : "; ") + light; }
};

/// Makes a scene visible to `camera`. If its own lights show hardly anything, it gets a neutral studio; rooms into
/// which the sky shines get a pale sky, and closed ones a lamp at the camera. From inside of rooms that are seen from
/// outside only, `Scene::camera` becomes a camera in there.
[[nodiscard]] Chosen make_visible(Scene& scene, const Camera& camera, float aspect, const MayChoose& may);
/// As the scene's own camera sees it, else the automatic one or one inside.
[[nodiscard]] Chosen make_visible(Scene& scene);

}  // namespace claray
