#include "host/io/gltf/gltf_lights.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/color.hpp"
#include "host/io/gltf/decode/gltf_value.hpp"

namespace claray {
namespace {

using std::to_string;

constexpr const char* punctual_lights = "KHR_lights_punctual";
constexpr const char* image_lights = "EXT_lights_image_based";

/// CLARAY_attenuation: `constants` a0, a1, a2 of 1 / (a0 + a1 d + a2 d^2) instead of the inverse square.
glm::vec3 attenuation_of(const tinygltf::Light& light, const std::string& name, const GltfFile& file) {
    const auto found = light.extensions.find("CLARAY_attenuation");
    glm::vec3 constants{0.f, 0.f, 1.f};
    if (found == light.extensions.end()) return constants;
    const tinygltf::Value& values = found->second.Get("constants");
    for (int k = 0; k < 3; ++k) {
        const tinygltf::Value& value = values.Get(std::size_t(k));
        if (!value.IsNumber()) file.fail(name + " needs three constants of attenuation");
        constants[k] = float(value.GetNumberAsDouble());
    }
    return constants;
}

/// Its candela and lux are taken as W / sr and W / m^2, as emissive factors are as radiance.
Light punctual_light(const GltfFile& file, const PlacedNode& node, const tinygltf::Light& source, std::size_t index) {
    const std::string name = gltf_name("light", source.name, index);
    Light light;
    light.name = source.name;
    if (source.type == "directional")
        light.kind = LightKind::directional;
    else if (source.type == "spot")
        light.kind = LightKind::spot;
    else if (source.type != "point")
        file.fail(name + " has the unknown type '" + source.type + "'", "use point, spot or directional");
    light.position = position_of(node);
    if (light.kind != LightKind::point) light.direction = -axis_of(node, 2, file);
    for (int k = 0; k < 3; ++k)
        light.intensity[k] = float(source.intensity * (source.color.size() < 3 ? 1.0 : source.color[std::size_t(k)]));
    if (light.kind != LightKind::directional) light.range = float(source.range);
    light.attenuation = attenuation_of(source, name, file);
    if (light.kind == LightKind::spot) {
        light.inner_angle = float(source.spot.innerConeAngle);
        light.outer_angle = float(source.spot.outerConeAngle);
    }
    return light;
}

/// The object that an extension's `light` chooses among the `lights` of the file.
const tinygltf::Value& chosen_light(const GltfFile& file, const char* extension, const tinygltf::Value& use,
                                    const std::string& user) {
    static const tinygltf::Value none;
    const tinygltf::Value& root = gltf_extension(file.model.extensions, extension);
    const tinygltf::Value& lights = root.IsObject() && root.Has("lights") ? root.Get("lights") : none;
    const std::size_t count = lights.IsArray() ? lights.ArrayLen() : 0;
    const int index = gltf_index(use, "light", -1);
    if (index < 0 || std::size_t(index) >= count)
        file.fail(user + " refers to light " + to_string(index) + " of " + to_string(count) + " of " + extension);
    return lights.Get(std::size_t(index));
}

/// Linear radiance, upside down. Alpha divides the colour: "RGBD" of the extension.
Texture face_of(const Texture& image) {
    Texture face;
    face.name = image.name, face.width = image.width, face.height = image.height;
    face.channels = 3, face.format = TexelFormat::float32;
    const bool real = image.format == TexelFormat::float32;
    const auto value = [&](std::size_t at) { return real ? double(image.floats[at]) : image.bytes[at] / 255.0; };
    const auto linear = [&](double encoded) { return real ? encoded : decode_srgb(encoded); };
    for (std::size_t y = image.height; y-- > 0;)
        for (std::size_t x = 0; x < image.width; ++x) {
            const std::size_t at = (y * image.width + x) * image.channels;
            const double divisor = image.channels % 2 == 0 ? value(at + image.channels - 1) : 1.0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double radiance = linear(value(at + (image.channels < 3 ? 0 : k)));
                face.floats.push_back(divisor > 0 ? float(radiance / divisor) : 0.f);
            }
        }
    return face;
}

/// Those of the finest level, +x -x +y -y +z -z; fewer if images are missing.
std::vector<Texture> faces_of(const GltfFile& file, const tinygltf::Value& light, const GltfImages& images) {
    static const tinygltf::Value none;
    const tinygltf::Value& levels =
        light.IsObject() && light.Has("specularImages") ? light.Get("specularImages") : none;
    const tinygltf::Value& finest = levels.IsArray() && levels.ArrayLen() > 0 ? levels.Get(0) : none;
    if (!finest.IsArray() || finest.ArrayLen() != 6)
        file.fail(std::string("a light of ") + image_lights + " has no six specularImages");
    std::vector<Texture> faces;
    for (std::size_t i = 0; i < 6; ++i) {
        const int index = finest.Get(i).IsNumber() ? finest.Get(i).GetNumberAsInt() : -1;
        images.check(index, std::string("a light of ") + image_lights);
        const std::optional<Texture> image = images.decode(index, TexelFormat::srgb8, room_for_textures);
        if (image) faces.push_back(face_of(*image));
    }
    for (const Texture& face : faces)
        if (face.width != face.height || face.width != faces[0].width)
            file.fail(std::string("the specularImages of ") + image_lights + " are no squares of one size");
    return faces;
}

}  // namespace

void add_lights(const GltfFile& file, const PlacedNode& node, Scene& scene) {
    const tinygltf::Value& use = gltf_extension(node.node->extensions, punctual_lights);
    if (!use.IsObject() || !use.Has("light")) return;
    const int index = gltf_index(use, "light", -1);
    const std::vector<tinygltf::Light>& lights = file.model.lights;
    if (index < 0 || std::size_t(index) >= lights.size())
        file.fail(node.name + " refers to light " + to_string(index) + " of " + to_string(lights.size()));
    scene.lights.push_back(punctual_light(file, node, lights[std::size_t(index)], std::size_t(index)));
}

void add_environment(const GltfFile& file, const tinygltf::Scene& source, const GltfImages& images, Scene& scene,
                     Warnings& warnings) {
    const tinygltf::Value& use = gltf_extension(source.extensions, image_lights);
    if (!use.IsObject()) return;
    const tinygltf::Value& light = chosen_light(file, image_lights, use, "the scene");
    std::vector<Texture> faces = faces_of(file, light, images);
    if (faces.size() < 6) return;  // the missing ones are said
    const glm::vec4 turn = gltf_numbers<4>(light, "rotation", {0.f, 0.f, 0.f, 1.f});
    if (std::abs(turn.x) > 1e-4f || std::abs(turn.z) > 1e-4f)
        warnings.push_back(std::string("the environment of ") + image_lights +
                           " is tilted: claray turns it about +y only");
    scene.environment.images = std::move(faces);
    // The quaternion turns directions of the scene into those of the image: so its first implementation, Babylon.js,
    // reads it, and so EnvironmentTest of Khronos' sample models looks like its screenshot.
    scene.environment.rotation = -2.f * std::atan2(turn.y, turn.w);
    scene.environment.strength = gltf_number(light, "intensity", 1.f);
}

}  // namespace claray
