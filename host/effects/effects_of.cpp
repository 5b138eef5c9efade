// Which effects a scene uses, and scenes without some of them.
#include <algorithm>
#include <map>

#include "claray/effects.hpp"
#include "host/bsdf/material_data.hpp"
#include "host/effects/effects.hpp"
#include "host/effects/nested_media.hpp"
#include "host/lights/hot_spots.hpp"
#include "host/lights/lights.hpp"
#include "host/scene/placement.hpp"
#include "host/textures/cutouts.hpp"
#include "host/textures/texture_use.hpp"
#include "host/textures/textures.hpp"

namespace claray {
namespace {

bool is_lit(const glm::vec3& c) { return c.x > 0 || c.y > 0 || c.z > 0; }

Effect effect_of(const Material& m) {
    return m.kind == MaterialKind::glass && m.thin_walled ? Effect::thin_walls : effect_of(kind_of(m));
}

Effect effect_of(LightKind kind) {
    switch (kind) {
#define CLARAY_ROW(name, NAME, text, far, cone) \
    case LightKind::name: return Effect::name##_lights;
        CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
    }
    return Effect::point_lights;
}

/// "the material 'gold'", or the number of a thing without a name.
std::string described(const char* kind, const std::string& name, std::size_t index) {
    return std::string("the ") + kind + " " + (name.empty() ? std::to_string(index) : "'" + name + "'");
}

/// Calls `call(effect, kind of object, its name, its index)` for everything that needs an effect.
template <class Call>
class Visitor {
public:
    Visitor(const Scene& scene, Call call) : scene_(scene), call_(std::move(call)) {}

    void visit() {
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i)
            if (!scene_.meshes[i].normals.empty()) call_(Effect::smooth_normals, "mesh", scene_.meshes[i].name, i);
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i)
            if (has_colors(scene_.meshes[i])) call_(Effect::vertex_colors, "mesh", scene_.meshes[i].name, i);
        const std::vector<bool> used = used_materials(scene_), cut_outs = find_cut_outs(scene_, used);
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
            if (used[i]) visit(scene_.materials[i], i);
            if (cut_outs[i]) call_(Effect::cut_outs, "material", scene_.materials[i].name, i);
        }
        for (std::size_t i = 0; i < scene_.lights.size(); ++i)
            if (is_lit(scene_.lights[i].intensity)) visit(scene_.lights[i], i);
        for (const std::uint32_t medium : nested_media(scene_))
            call_(Effect::nested_media, "material", scene_.materials[medium].name, medium);
        if (may_have_lists(scene_)) call_(Effect::light_lists, "scene", scene_.name, 0);
        if (near_lights(scene_) >= LightSelection{}.for_a_tree) call_(Effect::many_lights, "scene", scene_.name, 0);
        for (const HotSpotPlace& place : find_hot_spots(scene_))
            call_(Effect::hot_spots, "light", scene_.lights[place.light].name, place.light);
        visit_surroundings();
        if (scene_.camera) visit(*scene_.camera);
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            call_(Effect::instances, "instance", {}, i);
            if (moves(scene_.instances[i])) call_(Effect::instance_motion, "instance", {}, i);
        }
        for (std::size_t i = 0; i < scene_.primitives.size(); ++i)
            if (primitive_count(scene_.primitives[i]) > 0)
                call_(Effect::primitives, "primitive set", scene_.primitives[i].name, i);
    }

private:
    void visit(const Light& light, std::size_t index) {
        call_(effect_of(light.kind), "light", light.name, index);
        if (has_falloff(light)) call_(Effect::light_falloff, "light", light.name, index);
        if (has_linear_range(light)) call_(Effect::linear_ranges, "light", light.name, index);
    }

    void visit(const Material& m, std::size_t index) {
        const auto call = [&](Effect effect, bool wanted) {
            if (wanted) call_(effect, "material", m.name, index);
        };
        const EffectSet of_bsdf = effects_of_bsdf(m);
        for (const Effect effect : all_effects()) call(effect, of_bsdf.has(effect));
        call(Effect::emissive_triangles, is_lit(m.emission));
        call(Effect::absorption, absorbs_inside(m));
        call(Effect::textures, is_anisotropic(m));  // its direction follows texture coordinates
        call(Effect::culling, m.cull_back);
        visit_textures(m);
        const auto call_map = [&](Effect effect, const TextureUse& use) {
            if (use.used()) call_(effect, "texture", texture(use.texture).name, use.texture);
        };
        call_map(Effect::normal_maps, m.normal_map);
        if (has_layered_coat(m)) call_map(Effect::normal_maps, m.clearcoat_normal_map);
        call_map(Effect::height_maps, m.height_map);
        call_map(Effect::light_maps, m.light_map);
        if (sampled_emission(m) < 0.f) call_map(Effect::emission_maps, m.emission_map);
    }

    void visit_textures(const Material& m) {
        for (const auto map : material_maps) {
            const TextureUse* use = &(m.*map);
            if (!use->used()) continue;
            const Texture& image = texture(use->texture);
            call_(Effect::textures, "texture", image.name, use->texture);
            if (reads_levels(image.filter)) call_(Effect::mip_maps, "texture", image.name, use->texture);
            if (image.filter == Filter::nearest_level)
                call_(Effect::nearest_levels, "texture", image.name, use->texture);
        }
    }

    void visit_surroundings() {
        const bool image = !scene_.environment.images.empty() && scene_.environment.strength > 0;
        if (image) call_(Effect::environment, "environment", scene_.environment.images[0].name, 0);
        if (is_lit(scene_.sky.horizon) || is_lit(scene_.sky.zenith)) call_(Effect::sky, "sky", {}, 0);
    }

    void visit(const Camera& camera) {
        if (camera.aperture_radius > 0) call_(Effect::depth_of_field, "camera", {}, 0);
        if (moves(camera)) call_(Effect::camera_motion, "camera", {}, 0);
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) \
    if (camera.projection == Projection::name) call_(Effect::name, "camera", {}, 0);
        CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
    }

    [[nodiscard]] const Texture& texture(std::uint32_t index) const {
        static const Texture none;
        return index < scene_.textures.size() ? scene_.textures[index] : none;
    }

    const Scene& scene_;
    Call call_;
};

void strip(Material& m, EffectSet effects) {
    const auto lost = [&](Effect effect) { return effects.has(effect); };
    if (lost(effect_of(m))) m.kind = MaterialKind::lambert;
    if (lost(Effect::emissive_triangles)) m.emission = glm::vec3(0.f);
    if (lost(Effect::metal)) m.metallic = 0.f;
    if (lost(Effect::rough_glass) && has_rough_glass(m)) m.roughness = m.clearcoat_roughness = 0.f;
    if (lost(Effect::coated_metal) && has_coated_metal(m)) m.clearcoat = 0.f;
    if (lost(m.thin_walled ? Effect::thin_walls : Effect::transmission)) m.transmission = 0.f, m.transmission_map = {};
    if (lost(Effect::clearcoat)) m.clearcoat = 0.f, m.clearcoat_map = {};
    if (lost(Effect::layered_coat) && has_layered_coat(m)) m.clearcoat = 0.f;
    if (lost(Effect::specular))
        m.specular_weight = 1.f, m.specular_tint = glm::vec3(1.f), m.specular_map = m.specular_weight_map = {};
    if (lost(Effect::iridescence)) m.iridescence = 0.f, m.iridescence_map = m.film_thickness_map = {};
    if (lost(Effect::anisotropy)) m.anisotropy = 0.f, m.anisotropy_map = {};
    if (lost(Effect::sheen)) m.sheen = glm::vec3(0.f), m.sheen_map = m.sheen_roughness_map = {};
    if (lost(Effect::absorption)) m.attenuation_distance = 0.f;
    if (lost(Effect::culling)) m.cull_back = false;
    if (lost(Effect::cut_outs)) m.alpha_mode = AlphaMode::opaque;
    if (lost(Effect::textures))
        for (const auto map : material_maps) m.*map = {};
    if (lost(Effect::textures)) m.opacity_map = {}, m.anisotropy = 0.f;
    if (lost(Effect::normal_maps)) m.normal_map = m.clearcoat_normal_map = {};
    if (lost(Effect::height_maps)) m.height_map = {};
    if (lost(Effect::light_maps)) m.light_map = {};
    if (lost(Effect::emission_maps)) m.emission_map = {};
}

}  // namespace

Effect effect_of(MaterialKind kind) {
    switch (kind) {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) \
    case MaterialKind::name: return Effect::name;
        CLARAY_MATERIAL_KINDS(CLARAY_ROW) CLARAY_CUSTOM_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
    }
    return Effect::lambert;
}

EffectSet effects_of_bsdf(const Material& m) {
    EffectSet effects{effect_of(m)};
    const auto call = [&](Effect effect, bool wanted) {
        if (wanted) effects.add(effect);
    };
    const bool principled = kind_of(m) == MaterialKind::principled;
    call(Effect::metal, principled && m.metallic > 0);
    call(Effect::transmission, principled && m.transmission > 0 && !m.thin_walled);
    call(Effect::thin_walls, principled && has_thin_walls(m));
    call(Effect::rough_glass, has_rough_glass(m));
    call(Effect::clearcoat, has_clearcoat(m));
    call(Effect::coated_metal, has_coated_metal(m));
    call(Effect::layered_coat, has_layered_coat(m));
    call(Effect::specular, has_specular_layer(m));
    call(Effect::iridescence, has_film(m));
    call(Effect::anisotropy, is_anisotropic(m));
    call(Effect::sheen, has_sheen(m));
    return effects & known_effects();
}

std::vector<EffectCause> causes_of_effects(const Scene& scene) {
    std::map<Effect, EffectCause> causes;
    Visitor visitor(scene, [&](Effect effect, const char* kind, const std::string& name, std::size_t index) {
        EffectCause& cause = causes[effect];
        if (cause.count++ > 0) return;
        cause.effect = effect;
        const bool only_one = kind == std::string_view("camera") || kind == std::string_view("sky");
        cause.first = only_one ? std::string("the ") + kind : described(kind, name, index);
    });
    visitor.visit();
    std::vector<EffectCause> found;
    for (const Effect effect : all_effects())
        if (const auto cause = causes.find(effect); cause != causes.end()) found.push_back(cause->second);
    return found;
}

EffectSet effects_of(const Scene& scene) {
    EffectSet effects;
    Visitor visitor(scene, [&](Effect effect, const char*, const std::string&, std::size_t) { effects.add(effect); });
    visitor.visit();
    return effects & known_effects();
}

Scene without_effects(Scene scene, EffectSet effects) {
    const auto lost = [&](Effect effect) { return effects.has(effect); };
    for (Mesh& mesh : scene.meshes) {
        if (lost(Effect::smooth_normals)) mesh.normals.clear();
        if (lost(Effect::vertex_colors)) mesh.colors.clear();
    }
    if (lost(Effect::nested_media))
        for (const std::uint32_t medium : nested_media(scene)) scene.materials[medium].kind = MaterialKind::lambert;
    for (Material& material : scene.materials) strip(material, effects);
    for (Texture& texture : scene.textures) {
        if (lost(Effect::nearest_levels) && texture.filter == Filter::nearest_level) texture.filter = Filter::trilinear;
        if (lost(Effect::mip_maps) && reads_levels(texture.filter)) texture.filter = Filter::bilinear;
    }
    std::erase_if(scene.lights, [&](const Light& light) { return lost(effect_of(light.kind)); });
    for (Light& light : scene.lights) {
        if (lost(Effect::light_falloff)) light.range = 0.f, light.attenuation = {0.f, 0.f, 1.f};
        if (lost(Effect::linear_ranges)) light.linear_range = false;
    }
    if (lost(Effect::sky)) scene.sky = {};
    if (lost(Effect::environment)) scene.environment = {};
    if (scene.camera && lost(Effect::depth_of_field)) scene.camera->aperture_radius = 0.f;
    if (scene.camera && lost(Effect::camera_motion)) scene.camera->position_end = scene.camera->target_end = {};
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch)                               \
    if (scene.camera && scene.camera->projection == Projection::name && lost(Effect::name)) \
        scene.camera->projection = Projection::perspective;
    CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
    for (MeshInstance& instance : scene.instances)
        if (lost(Effect::instance_motion)) instance.transform_end = {};
    if (lost(Effect::instances)) scene.instances.clear();
    if (lost(Effect::primitives)) scene.primitives.clear();
    return scene;
}

}  // namespace claray
