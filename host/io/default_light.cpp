#include "host/io/default_light.hpp"

#include <cmath>

#include "claray/error.hpp"
#include "host/lights/light_probe.hpp"

namespace claray {
namespace {

/// Whoever puts lights into a file chose what they reach. Lamps alone are no such choice: most viewers show what
/// shines, and light the scene by something else.
bool is_lit(const Scene& scene, const LightProbe& probe) {
    constexpr double a_part = 0.1, half = 0.5, all_but_some = 0.9;
    return probe.lit >= (scene.lights.empty() ? half : a_part) || probe.visible >= all_but_some;
}

/// Grey in front of it is mid-grey in the image, at whatever distance.
Light lamp_at(const Camera& camera) {
    Light light = point_light(camera.position, glm::vec3(2.5f));
    light.name = "lamp at the camera";
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
    const long per_cent = std::lround(100 * probe.visible);
    const std::string share = per_cent > 0 ? std::to_string(per_cent) + " %" : "less than 1 %";
    return "the file's own light reaches " + share + " of the visible surfaces";
}

}  // namespace

std::optional<std::string> light_if_dark(Scene& scene, const Camera& camera, float aspect) {
    const LightProbe probe = probe_light(scene, camera, aspect);
    if (is_lit(scene, probe)) return {};
    constexpr double hardly_any = 0.05;
    const std::string why = reason(probe);
    if (probe.seen == 0 || probe.open >= hardly_any) {
        scene.sky = {{0.2f, 0.23f, 0.28f}, {1.1f, 1.15f, 1.25f}};  // dark behind what is lit from above
        return why + ": added a pale sky as light";
    }
    if (probe.visible >= hardly_any) return {};  // a room with little light, to which a sky would add none
    scene.lights.push_back(lamp_at(camera));
    return why + ", and a sky would not help: added a lamp at the camera";
}

std::optional<std::string> light_if_dark(Scene& scene) {
    const bool own = scene.camera && is_usable(*scene.camera);
    const Camera camera = own ? *scene.camera : automatic_camera(bounds_of(scene));
    return is_usable(camera) ? light_if_dark(scene, camera, 1.f) : std::nullopt;
}

namespace {

Scene lit(Scene scene, Warnings& warnings) {
    if (const auto line = light_if_dark(scene)) warnings.push_back(*line);
    return scene;
}

}  // namespace

Scene load_obj(const std::filesystem::path& path, Warnings& warnings) {
    return lit(load_obj_without_light(path, warnings, {}), warnings);
}

Scene load_ply(const std::filesystem::path& path, Warnings& warnings) {
    return lit(load_ply_without_light(path, warnings, {}), warnings);
}

Scene load_stl(const std::filesystem::path& path, Warnings& warnings) {
    return lit(load_stl_without_light(path, warnings), warnings);
}

Scene load_gltf(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options) {
    return lit(load_gltf_without_light(path, warnings, options), warnings);
}

Scene load_scene(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    LoadedScene loaded = load_without_light(name_or_path, warnings, options);
    return loaded.is_file ? lit(std::move(loaded.scene), warnings) : std::move(loaded.scene);
}

}  // namespace claray
