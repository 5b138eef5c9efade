// Checks that a scene can be rendered.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "claray/error.hpp"
#include "claray/scene.hpp"
#include "host/base/format.hpp"
#include "host/scene/validate.hpp"

namespace claray {
namespace {

using std::to_string;

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::user, what, remedy);
}

std::string name_of(const std::string& kind, const std::string& name, std::size_t index) {
    return name.empty() ? kind + " " + to_string(index) : kind + " '" + name + "'";
}

bool finite(const glm::vec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }
bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool sound(float value) { return std::isfinite(value) && value >= 0.f; }
bool sound(const glm::vec3& v) { return sound(v.x) && sound(v.y) && sound(v.z); }
bool share(float value) { return value >= 0.f && value <= 1.f; }
bool share(const glm::vec3& v) { return share(v.x) && share(v.y) && share(v.z); }

/// Reports an error of one object.
class Check {
public:
    explicit Check(std::string name) : name_(std::move(name)) {}
    void sound(bool ok, const char* value) const {
        if (!ok) refuse(name_ + ": its " + value + " is negative or not finite", "correct the value");
    }
    void finite(bool ok, const char* value) const {
        if (!ok) refuse(name_ + ": its " + value + " is not finite", "correct the value");
    }
    void share(bool ok, const char* value) const {
        if (!ok) refuse(name_ + ": its " + value + " is not in 0..1", "correct the value");
    }
    void that(bool ok, const std::string& fault, const char* remedy) const {
        if (!ok) refuse(name_ + ": " + fault, remedy);
    }

private:
    std::string name_;
};

void check_length(const Check& check, const char* array, std::size_t length, std::size_t expected, const char* per) {
    check.that(length == 0 || length == expected,
               to_string(length) + " " + array + " for " + to_string(expected) + " " + per,
               "give one per element, or none");
}

/// Positions may have any values, but coordinates that look something up must be finite.
template <class Vectors>
void check_vectors(const Check& check, const char* array, const Vectors& vectors) {
    for (std::size_t i = 0; i < vectors.size(); ++i)
        for (int k = 0; k < Vectors::value_type::length(); ++k)
            if (!std::isfinite(vectors[i][k]))
                check.that(false, "vertex " + to_string(i) + " of its " + array + " is not finite",
                           "correct the value");
}

void check_mesh(const Mesh& mesh, const Check& check, std::size_t materials) {
    check_length(check, "normals", mesh.normals.size(), mesh.positions.size(), "vertices");
    check_length(check, "texture coordinates", mesh.uvs.size(), mesh.positions.size(), "vertices");
    check_length(check, "second texture coordinates", mesh.uvs1.size(), mesh.positions.size(), "vertices");
    check_length(check, "tangents", mesh.tangents.size(), mesh.positions.size(), "vertices");
    check_length(check, "colours", mesh.colors.size(), mesh.positions.size(), "vertices");
    check_length(check, "materials", mesh.materials.size(), mesh.triangles.size(), "triangles");
    check_vectors(check, "texture coordinates", mesh.uvs);
    check_vectors(check, "second texture coordinates", mesh.uvs1);
    check_vectors(check, "tangents", mesh.tangents);
    for (std::size_t i = 0; i < mesh.colors.size(); ++i)
        if (!share(glm::vec3(mesh.colors[i])) || !share(mesh.colors[i].w))
            check.that(false, "the colour of vertex " + to_string(i) + " is not in 0..1", "correct the value");
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3& t = mesh.triangles[i];
        for (int k = 0; k < 3; ++k)
            if (t[k] >= mesh.positions.size())
                check.that(false,
                           "triangle " + to_string(i) + " refers to vertex " + to_string(t[k]) + " of " +
                               to_string(mesh.positions.size()),
                           "indices count from 0");
        const std::uint32_t material = mesh.materials.empty() ? 0 : mesh.materials[i];
        if (material >= materials)
            check.that(false,
                       "triangle " + to_string(i) + " refers to material " + to_string(material) + " of " +
                           to_string(materials),
                       "add the material to the scene");
    }
}

void check_texture_use(const TextureUse& use, const Check& check, const std::string& name, std::size_t textures) {
    if (!use.used()) return;
    check.that(use.texture < textures,
               "its " + name + " refers to texture " + to_string(use.texture) + " of " + to_string(textures),
               "add the texture to the scene");
    check.that(use.uv_set < 2, "its " + name + " uses texture coordinates " + to_string(use.uv_set),
               "meshes have the sets 0 and 1");
    check.that(finite(use.offset) && finite(use.scale) && std::isfinite(use.rotation),
               "the transform of its " + name + " is not finite", "correct the value");
}

/// Calls visit(map, its name).
template <class Visit>
void for_each_map(const Material& material, const Visit& visit) {
    const std::pair<const TextureUse*, const char*> maps[] = {
        {&material.albedo_map, "albedo map"},
        {&material.emission_map, "emission map"},
        {&material.metallic_roughness_map, "metallic-roughness map"},
        {&material.transmission_map, "transmission map"},
        {&material.clearcoat_map, "clearcoat map"},
        {&material.clearcoat_roughness_map, "clearcoat roughness map"},
        {&material.clearcoat_normal_map, "clearcoat normal map"},
        {&material.specular_map, "specular map"},
        {&material.specular_weight_map, "specular weight map"},
        {&material.shininess_map, "shininess map"},
        {&material.sheen_map, "sheen map"},
        {&material.sheen_roughness_map, "sheen roughness map"},
        {&material.anisotropy_map, "anisotropy map"},
        {&material.iridescence_map, "iridescence map"},
        {&material.film_thickness_map, "film thickness map"},
        {&material.opacity_map, "opacity map"},
        {&material.normal_map, "normal map"},
        {&material.height_map, "height map"},
        {&material.light_map, "light map"},
    };
    for (const auto& [use, name] : maps) visit(*use, name);
}

void check_material(const Material& material, const Check& check, std::size_t textures) {
    check.that(row_of(material.kind) != nullptr || material.kind == MaterialKind::custom, "unknown kind",
               "use a MaterialKind");
    check.finite(
        std::all_of(material.parameters.begin(), material.parameters.end(), [](float p) { return std::isfinite(p); }),
        "parameters");
    check.that(material.alpha_mode <= AlphaMode::blend, "unknown alpha mode", "use an AlphaMode");
    check.sound(sound(material.albedo), "albedo");
    check.sound(sound(material.emission), "emission");
    check.share(share(material.roughness), "roughness");
    check.sound(sound(material.ior) && material.ior > 0.f, "index of refraction");
    check.share(share(material.metallic), "metallic");
    check.share(share(material.transmission), "transmission");
    check.share(share(material.clearcoat), "clearcoat");
    check.share(share(material.clearcoat_roughness), "clearcoat roughness");
    check.sound(sound(material.specular), "specular colour");
    check.share(share(material.specular_weight), "specular weight");
    check.sound(sound(material.specular_tint), "specular tint");
    check.share(share(material.sheen), "sheen colour");
    check.share(share(material.sheen_roughness), "sheen roughness");
    check.share(share(material.anisotropy), "anisotropy");
    check.finite(std::isfinite(material.anisotropy_rotation), "anisotropy rotation");
    check.share(share(material.iridescence), "iridescence");
    check.sound(sound(material.iridescence_ior) && material.iridescence_ior > 0.f,
                "index of refraction of its iridescence");
    check.sound(sound(material.film_thickness.x) && sound(material.film_thickness.y), "film thickness");
    check.finite(std::isfinite(material.clearcoat_normal_scale), "clearcoat normal scale");
    check.share(share(material.attenuation), "attenuation colour");
    check.sound(sound(material.attenuation_distance), "attenuation distance");
    check.share(share(material.opacity), "opacity");
    check.sound(sound(material.alpha_cutoff), "alpha cutoff");
    check.that(material.alpha_test <= AlphaTest::not_equal, "unknown alpha test", "use an AlphaTest");
    check.that(material.role <= MaterialRole::shadow_catcher, "unknown role", "use a MaterialRole");
    check.finite(std::isfinite(material.normal_scale), "normal scale");
    check.finite(std::isfinite(material.height_scale), "height scale");
#define CLARAY_ROW(name, text, standard, kind) check.kind(kind(material.name), text);
    CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
    for_each_map(material,
                 [&](const TextureUse& use, const char* name) { check_texture_use(use, check, name, textures); });
}

/// `radiance`: no texel may be negative.
void check_texture(const Texture& texture, const Check& check, bool radiance) {
    const bool real = texture.format == TexelFormat::float32;
    check.that(texture.format <= TexelFormat::float32, "unknown texel format", "use a TexelFormat");
    check.that(
        texture.wrap_u <= Wrap::clamp && texture.wrap_v <= Wrap::clamp && texture.filter <= Filter::nearest_level,
        "unknown wrap mode or filter", "use a Wrap and a Filter");
    check.that(texture.width > 0 && texture.height > 0, "it has no texels", "give a width and a height");
    check.that(texture.channels >= 1 && texture.channels <= 4, to_string(texture.channels) + " channels", "use 1 to 4");
    const std::size_t expected = std::size_t(texture.width) * texture.height * texture.channels;
    const std::size_t size = real ? texture.floats.size() : texture.bytes.size();
    check.that(size == expected && (real ? texture.bytes.size() : texture.floats.size()) == 0,
               to_string(size) + (real ? " floats" : " bytes") + " for " + to_string(texture.width) + "x" +
                   to_string(texture.height) + " texels of " + to_string(texture.channels) + " channels",
               "give width * height * channels values of its format, and none of the other format");
    for (std::size_t i = 0; i < texture.floats.size(); ++i) {
        const float value = texture.floats[i];
        if (std::isfinite(value) && (value >= 0.f || !radiance)) continue;
        const std::size_t texel = i / texture.channels;
        check.that(false,
                   "texel (" + to_string(texel % texture.width) + ", " + to_string(texel / texture.width) + ") is " +
                       to_string(value),
                   radiance ? "radiance is finite and not negative" : "texels are finite");
    }
}

std::string in_degrees(float radians) { return printed("%.5g", radians * (180. / std::numbers::pi)); }

void check_light(const Light& light, const Check& check) {
    const LightTraits* kind = traits_of(light.kind);
    check.that(kind != nullptr, "unknown kind", "use a LightKind");
    check.finite(finite(light.position), "position");
    check.sound(sound(light.intensity), "intensity");
    check.sound(sound(light.range), "range");
    check.sound(sound(light.attenuation), "attenuation");
    check.that(light.attenuation != glm::vec3(0.f), "its attenuation is 0 everywhere",
               "the physical inverse square is 0, 0, 1");
    if (!kind->far && !kind->cone) return;
    const float length = glm::length(light.direction);
    check.that(std::isfinite(length) && length > 0.f, "its direction is none", "give a finite direction other than 0");
    if (!kind->cone) return;
    constexpr float right_angle = 1.57079637f;  // rounded up, so that a right angle is accepted
    check.that(
        light.inner_angle >= 0.f && light.inner_angle <= light.outer_angle && light.outer_angle <= right_angle &&
            light.outer_angle > 0.f,
        "its cone is from " + in_degrees(light.inner_angle) + " to " + in_degrees(light.outer_angle) + " degrees",
        "use 0 <= inner <= outer <= 90 degrees, outer above 0; members of Light are in radians");
}

void check_environment(const Environment& environment) {
    const Check check("environment");
    const std::size_t images = environment.images.size();
    check.sound(sound(environment.strength), "strength");
    check.finite(std::isfinite(environment.rotation), "rotation");
    check.that(images == 0 || images == 1 || images == 6, to_string(images) + " images",
               "give one image in latitude and longitude, or the six faces of a cube");
    for (std::size_t i = 0; i < images; ++i) {
        const Texture& image = environment.images[i];
        check_texture(image, Check(name_of("environment image", image.name, i)), true);
        if (images == 6)
            check.that(
                image.width == image.height && image.width == environment.images[0].width,
                "face " + to_string(i) + " of its cube is " + to_string(image.width) + "x" + to_string(image.height),
                "use squares of equal size");
    }
}

void check_camera(const Camera& camera) {
    const Check check("camera");
    check.sound(sound(camera.aperture_radius), "aperture radius");
    check.sound(sound(camera.focus_distance), "focus distance");
    check.sound(sound(camera.orthographic_height), "orthographic height");
    check.finite(!camera.position_end || finite(*camera.position_end), "position when the shutter closes");
    check.finite(!camera.target_end || finite(*camera.target_end), "target when the shutter closes");
}

/// The determinant after scaling the largest entry to 1 distinguishes a flat transform from a small one.
void check_transform(const glm::mat4& transform, const Check& check, const char* when) {
    float largest = 0.f;
    bool all_finite = true;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            all_finite = all_finite && std::isfinite(transform[column][row]);
            if (column < 3 && row < 3) largest = std::max(largest, std::abs(transform[column][row]));
        }
    const std::string what = std::string("its transform") + when;
    check.that(all_finite, what + " is not finite", "correct the value");
    check.that(transform[0][3] == 0.f && transform[1][3] == 0.f && transform[2][3] == 0.f && transform[3][3] == 1.f,
               what + " is not affine", "its last row must be 0 0 0 1");
    const double determinant = largest > 0.f ? glm::determinant(glm::dmat3(transform) / double(largest)) : 0.0;
    check.that(std::abs(determinant) > 1e-30, what + " cannot be inverted", "use scales other than 0");
}

void check_instance(const MeshInstance& instance, const Check& check, std::size_t meshes) {
    check.that(instance.mesh < meshes, "it refers to mesh " + to_string(instance.mesh) + " of " + to_string(meshes),
               "indices count from 0");
    check_transform(instance.transform, check, "");
    if (instance.transform_end) check_transform(*instance.transform_end, check, " when the shutter closes");
}

/// Why primitives cannot have the material; empty if they can.
std::string fault_on_primitives(const Material& material, bool curves) {
    bool maps = false;
    for_each_map(material, [&](const TextureUse& use, const char*) { maps = maps || use.used(); });
    if (maps) return "has a texture, but primitives have no texture coordinates";
    if (material.alpha_mode != AlphaMode::opaque && material.opacity < 1.f) return "lets rays through (opacity)";
    const bool transmits_light = transmits(material.kind) || material.transmission > 0.f;
    if (curves && transmits_light && !material.thin_walled) return "transmits light, but curves have no inside";
    return {};
}

void check_points_of(const PrimitiveSet& set, const Check& check) {
    if (!are_curves(set)) {
        const std::size_t each = points_per_primitive(set.kind);
        check.that(set.points.size() % each == 0,
                   to_string(set.points.size()) + " points, but its primitives have " + to_string(each) + " each",
                   "give whole primitives");
        check.that(set.segments.empty(), "it has segments, but is not of curves", "leave them out");
    }
    for (std::size_t i = 0; i < set.segments.size(); ++i)
        if (std::size_t(set.segments[i]) + 4 > set.points.size())
            check.that(false,
                       "segment " + to_string(i) + " begins at control point " + to_string(set.segments[i]) + " of " +
                           to_string(set.points.size()),
                       "a segment has four control points in a row");
}

void check_primitives(const PrimitiveSet& set, const Check& check, const std::vector<Material>& materials) {
    check.that(std::uint32_t(set.kind) < CLARAY_PRIMITIVE_KINDS, "unknown kind", "use a PrimitiveSet::Kind");
    check_points_of(set, check);
    const std::size_t count = primitive_count(set);
    check_length(check, "colours", set.colors.size(), 2 * count, "ends of primitives");
    check_length(check, "materials", set.materials.size(), count, "primitives");
    for (std::size_t i = 0; i < set.colors.size(); ++i)
        if (!share(set.colors[i])) check.that(false, "colour " + to_string(i) + " is not in 0..1", "correct the value");
    std::vector<bool> checked(materials.size());
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t material = set.materials.empty() ? 0 : set.materials[i];
        if (material >= materials.size())
            check.that(false,
                       "primitive " + to_string(i) + " refers to material " + to_string(material) + " of " +
                           to_string(materials.size()),
                       "add the material to the scene");
        if (checked[material]) continue;
        checked[material] = true;
        const std::string fault = fault_on_primitives(materials[material], are_curves(set));
        check.that(fault.empty(), "its " + name_of("material", materials[material].name, material) + " " + fault,
                   "give it another material, or use triangles");
    }
}

template <class Things, class Call>
void check_each(const Things& things, const char* kind, const Call& check) {
    for (std::size_t i = 0; i < things.size(); ++i) check(things[i], i, kind);
}

}  // namespace

void validate_materials(const Scene& scene) {
    check_each(scene.materials, "material", [&](const Material& material, std::size_t i, const char* kind) {
        check_material(material, Check(name_of(kind, material.name, i)), scene.textures.size());
    });
}

void validate_meshes(const Scene& scene) {
    check_each(scene.meshes, "mesh", [&](const Mesh& mesh, std::size_t i, const char* kind) {
        check_mesh(mesh, Check(name_of(kind, mesh.name, i)), scene.materials.size());
    });
}

/// Also after a change of materials.
void validate_primitives(const Scene& scene) {
    check_each(scene.primitives, "primitive set", [&](const PrimitiveSet& set, std::size_t i, const char* kind) {
        check_primitives(set, Check(name_of(kind, set.name, i)), scene.materials);
    });
}

std::optional<std::string> warning_of_lamps(const Scene& scene) {
    for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
        const PrimitiveSet& set = scene.primitives[i];
        for (std::size_t k = 0; k < primitive_count(set); ++k) {
            const std::uint32_t material = set.materials.empty() ? 0 : set.materials[k];
            if (material < scene.materials.size() && scene.materials[material].emission != glm::vec3(0.f))
                return name_of("primitive set", set.name, i) +
                       " emits light, which is found by scattered rays only: use triangles for lamps";
        }
    }
    return {};
}

bool may_be_on_primitives(const Material& material) { return fault_on_primitives(material, true).empty(); }

void validate_instances(const Scene& scene) {
    check_each(scene.instances, "instance", [&](const MeshInstance& instance, std::size_t i, const char* kind) {
        check_instance(instance, Check(name_of(kind, {}, i)), scene.meshes.size());
    });
}

void validate_lights(const Scene& scene) {
    check_each(scene.lights, "light", [&](const Light& light, std::size_t i, const char* kind) {
        check_light(light, Check(name_of(kind, light.name, i)));
    });
}

void validate_sky(const Scene& scene) {
#define CLARAY_ROW(name, text) Check("sky").sound(sound(scene.sky.name), text);
    CLARAY_SKY(CLARAY_ROW, CLARAY_ROW)
#undef CLARAY_ROW
}

void validate_camera(const Scene& scene) {
    if (scene.camera) check_camera(*scene.camera);
}

void validate(const Scene& scene) {
    check_each(scene.textures, "texture", [&](const Texture& texture, std::size_t i, const char* kind) {
        check_texture(texture, Check(name_of(kind, texture.name, i)), false);
    });
    validate_materials(scene);
    validate_meshes(scene);
    validate_primitives(scene);
    validate_instances(scene);
    validate_lights(scene);
    validate_sky(scene);
    check_environment(scene.environment);
    validate_camera(scene);
}

}  // namespace claray
