// Camera and light: options of all commands that make images of a scene.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "claray/io.hpp"
#include "host/cli/options/load.hpp"

namespace claray::cli {

/// A lens beyond its aperture.
struct LensOptions {
    std::optional<glm::vec2> shift, tilt;
    std::optional<Stereo> stereo;
    std::optional<float> eye_distance;                           // in units of the scene
    std::optional<float> focal_length, sensor_height, f_number;  // millimetres
};

struct ViewOptions {
    std::optional<glm::vec3> camera, look_at, up;
    std::optional<Projection> projection;
    std::optional<float> fov;                          // degrees, vertical
    std::optional<float> ortho;                        // height of the image, in units of the scene
    std::optional<float> aperture, focus_distance;     // of a thin lens
    std::optional<glm::vec3> camera_end, look_at_end;  // when the shutter closes
    LensOptions lens;
    LightOptions lights;
    SurfaceOptions surfaces;
    LoadOptions load;
    std::vector<std::string> edits;  // --set
    bool exposes = false;            // pictures take the exposure of a light that is chosen
};

/// An option of three numbers, X,Y,Z.
CLI::Option* add_vector_option(CLI::App& command, const char* name, glm::vec3& vector, const char* description);
void add_view_options(CLI::App& command, ViewOptions& options);

/// The first frame of an animation sets the automatic camera, and the light of a dark file, for all frames.
struct FirstFrame {
    std::optional<Camera> camera;
    std::optional<DefaultLight> light;

    /// Of pictures whose exposure is not given; empty: the light asks for none.
    [[nodiscard]] std::optional<float> exposure() const { return light ? light->exposure : std::nullopt; }
};

/// Loads a scene with the lights and the camera of the command line. Prints warnings, and throws as `load` does.
/// `first` belongs to an animation: its first frame sets it, the others use it.
[[nodiscard]] Scene load_view(const std::string& name, const ViewOptions& options, unsigned width, unsigned height,
                              FirstFrame* first = nullptr);

}  // namespace claray::cli
