// Which effects a scene uses, and scenes without some of them.
#include <map>

#include "claray/effects.hpp"
#include "host/effects/effects.hpp"
#include "host/effects/parts/part.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

/// "the material 'gold'", or the number of a thing without a name. A scene has one camera and one sky.
std::string described(const std::string& kind, const std::string& name, std::size_t index) {
    const bool only_one = kind == "camera" || kind == "sky";
    if (only_one) return "the " + kind;
    return "the " + kind + " " + (name.empty() ? std::to_string(index) : "'" + name + "'");
}

void find(const EffectPart& part, const SearchedScene& searched, const Found& found) {
    const Scene& scene = searched.scene;
    if (part.in_material)
        for_each_material(searched, [&](const Material& m, std::size_t i) {
            if (part.in_material(m)) found("material", m.name, i);
        });
    for (std::size_t i = 0; part.in_light && i < scene.lights.size(); ++i)
        if (is_lit(scene.lights[i].intensity) && part.in_light(scene.lights[i]))
            found("light", scene.lights[i].name, i);
    if (part.in_camera && scene.camera && part.in_camera(*scene.camera)) found("camera", {}, 0);
    if (part.find) part.find(searched, found);
}

void strip(const EffectPart& part, Scene& scene) {
    for (Material& m : scene.materials)
        if (part.strip_material && (!part.in_material || part.in_material(m))) part.strip_material(m);
    for (Light& light : scene.lights)
        if (part.strip_light) part.strip_light(light);
    if (part.strip_camera && scene.camera && part.in_camera(*scene.camera)) part.strip_camera(*scene.camera);
    if (part.strip) part.strip(scene);
}

}  // namespace

EffectSet effects_of_bsdf(const Material& m) {
    static const EffectSet of_bsdf = effects_with(CLARAY_OF_BSDF);
    EffectSet effects;
    for (const Effect effect : all_effects())
        if (of_bsdf.has(effect) && part_of(effect).in_material(m)) effects.add(effect);
    return effects;
}

std::vector<EffectCause> causes_of_effects(const Scene& scene) {
    const SearchedScene searched{scene, used_materials(scene)};
    std::vector<EffectCause> causes;
    for (const Effect effect : all_effects()) {
        EffectCause cause{.effect = effect, .first = {}, .count = 0};
        find(part_of(effect), searched, [&](const char* kind, const std::string& name, std::size_t index) {
            if (cause.count++ == 0) cause.first = described(kind, name, index);
        });
        if (cause.count > 0) causes.push_back(cause);
    }
    return causes;
}

EffectSet effects_of(const Scene& scene) {
    EffectSet effects;
    for (const EffectCause& cause : causes_of_effects(scene)) effects.add(cause.effect);
    return effects;
}

std::optional<Scene> prepared_for_effects(const Scene& scene) {
    std::optional<Scene> prepared;
    for (const Effect effect : all_effects())
        if (const auto prepare = part_of(effect).prepare)
            if (std::optional<Scene> changed = prepare(prepared ? *prepared : scene)) prepared = std::move(changed);
    return prepared;
}

Scene without_effects(Scene scene, EffectSet effects) {
    for (const Effect effect : all_effects())
        if (effects.has(effect)) strip(part_of(effect), scene);
    return scene;
}

}  // namespace claray
