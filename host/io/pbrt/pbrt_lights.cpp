// Lights of pbrt-v4. Its light of RGB 1 and scale 1 is read as 1 W / (m^2 sr), W / sr or W / m^2.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/io/image/image_file.hpp"
#include "host/io/pbrt/pbrt_scene.hpp"
#include "host/io/words.hpp"
#include "host/io/world/octahedral.hpp"

namespace claray {
namespace {

double pbrt_radians(double degrees) { return degrees * std::numbers::pi / 180; }

glm::vec3 moved(const glm::dmat4& m, const glm::dvec3& point) { return {m * glm::dvec4(point, 1)}; }

}  // namespace

void PbrtScene::add_light() {
    const std::string kind = tokens_.next_text();
    const PbrtParameters p = parameters_of("light");
    const bool near = kind == "point" || kind == "spot" || kind == "goniometric" || kind == "projection";
    if (kind == "infinite") return add_infinite(p);
    if (!near && kind != "distant") return world_.warn("lights " + claray::quoted(kind) + " are left out");
    const glm::dmat4 to_world = placed();
    const glm::dvec3 from = p.point("from", glm::dvec3(0)), to = p.point("to", {0, 0, 1});
    Light light;
    light.kind = kind == "distant" ? LightKind::directional : kind == "spot" ? LightKind::spot : LightKind::point;
    light.position = moved(to_world, from);
    const glm::vec3 along = moved(to_world, to) - light.position;
    if (glm::length(along) > 0) light.direction = glm::normalize(along);
    light.intensity = materials_.light(p, near ? "I" : "L", glm::vec3(1.f)) * float(p.number("scale", 1));
    if (kind == "distant") {
        if (const double lux = p.number("illuminance", -1); lux > 0) light.intensity *= float(lux);
        return world_.add(light);
    }
    const double cone = p.number("coneangle", 30), delta = p.number("conedeltaangle", 5);
    const double outside = pbrt_radians(std::clamp(cone, 0.01, 89.9)),
                 inside = std::min(pbrt_radians(std::clamp(cone - delta, 0.0, 89.9)), outside);
    set_cone(light, inside, outside, 0.5);  // the mean of pbrt's smooth step
    if (const double power = p.number("power", -1); power > 0) {
        const double inner = std::cos(inside), outer = std::cos(outside);
        const double steradians =
            kind == "spot" ? 2 * std::numbers::pi * ((1 - inner) + (inner - outer) / 2) : 4 * std::numbers::pi;
        light.intensity *= float(power / steradians);
    }
    if (kind == "goniometric" || kind == "projection")
        world_.warn("lights " + claray::quoted(kind) + " shine in all directions alike");
    world_.add(light);
}

void PbrtScene::add_infinite(const PbrtParameters& p) {
    if (p.find("portal")) world_.warn("portals of infinite lights are ignored");
    const auto scale = float(p.number("scale", 1));
    const std::string image = p.text("filename");
    if (!image.empty()) {
        if (p.find("illuminance")) world_.warn("the illuminance of images around the scene is ignored");
        return add_image_light(image, glm::vec3(scale));
    }
    glm::vec3 radiance = materials_.light(p, "L", glm::vec3(1.f)) * scale;
    if (const double lux = p.number("illuminance", -1); lux > 0) radiance *= float(lux / std::numbers::pi);
    world_.add_surroundings(radiance);
}

void PbrtScene::add_image_light(const std::string& name, const glm::vec3& scale) {
    const std::filesystem::path& scene = world_.paints().path();
    const auto file = read_image_of_scene(scene, scene.parent_path(), name, world_.paints().warnings());
    if (!file) return world_.add_surroundings(0.5f * scale);
    auto image = std::make_shared<const Texture>(decode_texture(file->bytes, file->name, TexelFormat::srgb8));
    if (image->width != image->height) world_.warn("the image around the scene is no square: it is stretched to one");
    const glm::dmat3 to_light = glm::inverse(glm::dmat3(placed()));
    const unsigned side = std::clamp(image->width, 4u, 4096u);
    world_.add_surroundings(2 * side, side, [image, to_light, scale](const glm::dvec3& direction) {
        return glm::dvec3(scale) * octahedral_color(*image, glm::normalize(to_light * direction));
    });
}

std::optional<Glow> PbrtScene::glow(double area) {
    if (!now_.lamp.on) return {};
    const PbrtParameters& p = now_.lamp.parameters;
    Glow glow;
    glow.both_sides = p.flag("twosided", false);
    auto scale = float(p.number("scale", 1));
    if (const double power = p.number("power", -1); power > 0 && area > 0)
        scale *= float(power / (std::numbers::pi * area * (glow.both_sides ? 2 : 1)));
    const std::string image = p.text("filename");
    if (image.empty()) {
        glow.radiance = Paint(materials_.light(p, "L", glm::vec3(1.f)) * scale);
    } else {
        glow.radiance = world_.paints().image(image, {});
        glow.radiance.factor *= scale;
    }
    return glow;
}

}  // namespace claray
