#include "host/io/default_light.hpp"

#include <cmath>

#include "claray/error.hpp"
#include "host/io/scene_readers.hpp"
#include "host/lights/inside_view.hpp"
#include "host/lights/studio.hpp"

namespace claray {
namespace {

constexpr double hardly_any = 0.05;

/// Whoever puts lights into a file chose what they reach. Lamps alone are no such choice: most viewers show what
/// shines, and light the scene by something else. An image around the scene is one. A scene that mostly shines may do
/// so because it is a picture, unless other surfaces stay dark in it.
bool is_lit(const Scene& scene, const LightProbe& probe) {
    constexpr double a_part = 0.1, half = 0.5, all_but_some = 0.9;
    if (!scene.environment.images.empty()) return true;
    const double enough = scene.lights.empty() ? half : a_part;
    if (probe.plain > 0 && probe.plain_lit < enough) return false;
    return probe.lit >= enough || probe.visible >= all_but_some;
}

/// Light from around the scene hardly reaches what the camera sees.
bool is_closed(const LightProbe& probe) { return probe.seen > 0 && probe.open < hardly_any; }

/// In a room of grey walls, which reflect as much again, grey in front of it is mid-grey in the image, at whatever
/// distance. `depth`: before the camera.
Light lamp_at(const Camera& camera, double depth) {
    const glm::dvec3 position(camera.position), view = glm::dvec3(camera.target) - position;
    Light light = point_light(glm::vec3(position + depth * glm::normalize(view)), glm::vec3(1.2f));
    light.name = depth > 0 ? "lamp before the camera" : "lamp at the camera";
    light.attenuation = {1.f, 0.f, 0.f};
    return light;
}

bool is_usable(const Camera& camera) {
    try {
        static_cast<void>(camera_data(camera, 1.f));
        return true;
    } catch (const Error&) {  // whoever renders with it is told
        return false;
    }
}

std::string reason(const LightProbe& probe) {
    if (probe.lights == 0) return "the file has no light";
    if (probe.visible == 0) return "no light of the file reaches the visible surfaces";
    const double share = probe.plain > 0 ? probe.plain_lit : probe.visible;
    const long per_cent = std::lround(100 * share);
    return "the file's own light reaches " + (per_cent > 0 ? std::to_string(per_cent) + " %" : "less than 1 %") +
           " of the visible surfaces" + (probe.plain > 0 && probe.plain < 1 ? " that do not shine" : "");
}

void light(Scene& scene, const Camera& camera, bool inside, const LightProbe& probe, Chosen& chosen) {
    if (is_lit(scene, probe)) return;
    const std::string why = reason(probe);
    if (!is_closed(probe)) {
        constexpr double everywhere = 0.9, seldom = 0.4;
        if (inside || (probe.seen >= everywhere && probe.open < seldom)) {  // its windows show what is outside
            chosen.added.sky = Sky{{0.2f, 0.23f, 0.28f}, {1.1f, 1.15f, 1.25f}};
            chosen.light = why + ": added a pale sky as light";
        } else {
            chosen.added.environment = studio(camera);
            chosen.light = why + ": added a neutral studio as light";
        }
    } else if (probe.visible < hardly_any) {  // else a room with little light, to which a sky would add none
        chosen.added.lamp = lamp_at(camera, probe.behind_backs);
        const bool behind = probe.behind_backs > 0;
        chosen.past_backs |= behind;
        chosen.light = why + ", and a sky would not help: added a lamp " +
                       (behind ? "behind the one-sided surfaces before the camera" : "at the camera");
    }
    add(scene, chosen.added);
}

/// In tenths of stops. Twice the average light still leaves white surfaces some room below the white of the picture.
float exposure_for(double white) {
    constexpr double medium = 0.5;  // which the filmic curve shows as 205 of 255
    return white > 0 ? float(std::round(10 * std::log2(medium / white)) / 10) : 0.f;
}

/// Outside of a room there is nothing to see, or its walls.
bool shows_outside(const LightProbe& probe) {
    constexpr double mostly = 0.6;
    return probe.seen > 0 && (probe.open >= mostly || (is_closed(probe) && probe.visible < hardly_any));
}

}  // namespace

void add(Scene& scene, const DefaultLight& light) {
    if (light.sky) scene.sky = *light.sky;
    if (light.environment) scene.environment = *light.environment;
    if (light.lamp) scene.lights.push_back(*light.lamp);
}

Chosen make_visible(Scene& scene, const Camera& camera, float aspect, const MayChoose& may) {
    Chosen chosen;
    if (!may.light && !may.view) return chosen;
    const ProbedScene probed(scene);
    LightProbe probe = probe_light(probed, camera, aspect);
    std::optional<Camera> inside;
    if (may.view && shows_outside(probe)) inside = inside_view(probed, may.inside_fov, aspect);
    if (inside) {
        chosen.past_backs = probe.behind_backs > 0;
        chosen.view = "the file is mostly rooms: the view is from inside";
        scene.camera = inside;
        probe = probe_light(probed, *inside, aspect);
    }
    if (may.light) light(scene, inside.value_or(camera), inside.has_value(), probe, chosen);
    if (chosen.added.sky || chosen.added.environment)
        chosen.added.exposure = exposure_for(log_average_of_white(probed, scene, inside.value_or(camera), aspect));
    return chosen;
}

Chosen make_visible(Scene& scene) {
    const bool own = scene.camera && is_usable(*scene.camera);
    const Camera camera = own ? *scene.camera : automatic_camera(scene);
    MayChoose may;
    may.view = !scene.camera;
    return is_usable(camera) ? make_visible(scene, camera, 1.f, may) : Chosen();
}

namespace {

Scene visible(Scene scene, Warnings& warnings) {
    const Chosen chosen = make_visible(scene);
    for (const std::string& line : {chosen.view, chosen.light})
        if (!line.empty()) warnings.push_back(line);
    return scene;
}

}  // namespace

Scene load_obj(const std::filesystem::path& path, Warnings& warnings) {
    return visible(load_obj_without_light(path, warnings, {}), warnings);
}

Scene load_ply(const std::filesystem::path& path, Warnings& warnings) {
    return visible(load_ply_without_light(path, warnings, {}), warnings);
}

Scene load_stl(const std::filesystem::path& path, Warnings& warnings) {
    return visible(load_stl_without_light(path, warnings, {}), warnings);
}

Scene load_gltf(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options) {
    return visible(load_gltf_without_light(path, warnings, options), warnings);
}

Scene load_scene(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    LoadedScene loaded = load_without_light(name_or_path, warnings, options);
    return loaded.is_file ? visible(std::move(loaded.scene), warnings) : std::move(loaded.scene);
}

}  // namespace claray
