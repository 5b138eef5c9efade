// Emitters and sensors of Mitsuba 3.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "host/io/image/image_file.hpp"
#include "host/io/mitsuba/mitsuba_scene.hpp"
#include "host/io/words.hpp"
#include "host/io/world/octahedral.hpp"

namespace claray {
namespace {

double mitsuba_radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// The mean over cosines of what falls with the angle, from 1 to 0.
double mean_falloff(double inner, double outer) {
    const double angle = outer - inner, cosines = std::cos(inner) - std::cos(outer);
    if (!(angle > 1e-6 && cosines > 0)) return 0.5;
    return (angle * std::cos(inner) + std::sin(inner) - std::sin(outer)) / (angle * cosines);
}

/// Longitude along the width from -z over +x, latitude along the height from +y; the first and the last row are poles'.
glm::dvec3 sphere_color(const Texture& image, const glm::dvec3& direction) {
    const double u = std::atan2(direction.x, -direction.z) / (2 * std::numbers::pi),
                 v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / std::numbers::pi;
    const double x = (u - std::floor(u)) * image.width - 0.5, y = v * image.height - 0.5;
    const double column = std::floor(x), row = std::floor(y);
    const auto width = std::int64_t(image.width), height = std::int64_t(image.height);
    glm::dvec3 sum(0.0);
    for (int i = 0; i < 4; ++i) {
        const std::int64_t at = (std::int64_t(column) + (i & 1) + width) % width,
                           line = std::clamp<std::int64_t>(std::int64_t(row) + (i >> 1), 0, height - 1);
        const double tx = x - column, ty = y - row;
        sum += ((i & 1) ? tx : 1 - tx) * ((i >> 1) ? ty : 1 - ty) * linear_texel(image, unsigned(at), unsigned(line));
    }
    return sum;
}

}  // namespace

void MitsubaScene::add_emitter(const MitsubaNode& emitter) {
    const std::string& type = emitter.type;
    if (type == "constant") return world_.add_surroundings(materials_.light(emitter, "radiance", 1.f).factor);
    if (type == "envmap") return add_image_light(emitter);
    if (type != "point" && type != "spot" && type != "directional")
        return world_.warn("emitters " + claray::quoted(type) + " are left out");
    const glm::dmat4 to_world = mirror_ * emitter.transform("to_world");
    Light light;
    light.name = emitter.id;
    light.kind = type == "spot" ? LightKind::spot : type == "point" ? LightKind::point : LightKind::directional;
    light.position = glm::vec3(to_world * glm::dvec4(emitter.point("position", glm::dvec3(0)), 1));
    const bool stated = emitter.property("direction") != nullptr;
    const glm::dvec3 along = stated ? glm::dvec3(mirror_ * glm::dvec4(emitter.point("direction", {0, 0, 1}), 0))
                                    : glm::dvec3(to_world * glm::dvec4(0, 0, 1, 0));
    if (glm::length(along) > 0) light.direction = glm::vec3(glm::normalize(along));
    light.intensity = materials_.light(emitter, type == "directional" ? "irradiance" : "intensity", 1.f).factor;
    const double cutoff = emitter.number("cutoff_angle", 20);
    const double outside = mitsuba_radians(std::clamp(cutoff, 0.01, 89.9)),
                 beam = mitsuba_radians(std::clamp(emitter.number("beam_width", cutoff * 0.75), 0.0, 89.9));
    set_cone(light, std::min(beam, outside), outside, mean_falloff(std::min(beam, outside), outside));
    if (emitter.property("texture")) world_.warn("textures of spots are left out");
    world_.add(light);
}

void MitsubaScene::add_image_light(const MitsubaNode& emitter) {
    const std::filesystem::path& scene = world_.paints().path();
    const auto scale = emitter.number("scale", 1);
    const auto file =
        read_image_of_scene(scene, scene.parent_path(), emitter.text("filename"), world_.paints().warnings());
    if (!file) return world_.add_surroundings(glm::vec3(float(0.5 * scale)));
    auto image = std::make_shared<const Texture>(decode_texture(file->bytes, file->name, TexelFormat::srgb8));
    const glm::dmat3 to_light = glm::inverse(glm::dmat3(mirror_ * emitter.transform("to_world")));
    world_.add_surroundings(image->width, image->height, [image, to_light, scale](const glm::dvec3& direction) {
        return scale * sphere_color(*image, glm::normalize(to_light * direction));
    });
}

// ---- the camera

void MitsubaScene::set_fov(const MitsubaNode& sensor, View& view) {
    if (const std::string focal = sensor.text("focal_length"); !focal.empty()) {
        const double millimetres = number_in(focal.substr(0, focal.find("mm"))).value_or(50);
        view.fov = 2 / std::numbers::pi * 180 * std::atan(std::hypot(36, 24) / 2 / std::max(millimetres, 1e-3));
        view.fov_along = View::Along::diagonal;
        return;
    }
    view.fov = std::clamp(sensor.number("fov", 90), 0.01, 179.0);
    const std::string axis = sensor.text("fov_axis", "x");
    view.fov_along = axis == "y"          ? View::Along::height
                     : axis == "diagonal" ? View::Along::diagonal
                     : axis == "smaller"  ? View::Along::shorter
                     : axis == "larger"   ? View::Along::longer
                                          : View::Along::width;
}

/// Mitsuba's camera looks along +z, with +x to the left.
void MitsubaScene::set_camera(const MitsubaNode& sensor) {
    const std::string& type = sensor.type;
    View view;
    const MitsubaNode* stated = materials_.child(sensor, "film");
    const SceneFilm film = stated ? film_of(*stated) : default_film;
    view.width = film.width, view.height = film.height;
    set_fov(sensor, view);
    if (type == "orthographic") view.projection = Projection::orthographic;
    if (type != "orthographic" && type != "perspective" && type != "thinlens")
        world_.warn("the sensor " + claray::quoted(type) + " is shown as 'perspective'");
    if (type == "thinlens")
        view.lens_radius = sensor.number("aperture_radius", 0),
        view.focus_distance = sensor.number("focus_distance", 0);
    if (sensor.number("principal_point_offset_x", 0) != 0 || sensor.number("principal_point_offset_y", 0) != 0)
        world_.warn("the camera's view is centred: the offset of its principal point is ignored");
    const glm::dmat4 to_world = sensor.transform("to_world");
    const double turn = glm::determinant(glm::dmat3(to_world));
    if (!(std::abs(turn) > 1e-30 && std::isfinite(turn)))
        sensor.refuse("the camera's transform is not invertible", "correct it");
    if (turn < 0) mirror_ = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
    view.half_height = glm::length(glm::dvec3(to_world[0])) * view.height / view.width;
    view.to_world = mirror_ * to_world;
    view.to_world[0] = -view.to_world[0];
    world_.set_view(view);
}

}  // namespace claray
