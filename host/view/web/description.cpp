#include "host/view/web/description.hpp"

#include <map>
#include <nlohmann/json.hpp>

#include "claray/effects.hpp"
#include "host/view/camera_control.hpp"
#include "host/view/edit/values.hpp"
#include "host/view/input.hpp"

namespace claray::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_rows = 2000;     // of a list; more are counted only
constexpr std::size_t most_letters = 1000;  // of what a command told

Json triple(const glm::vec3& v) { return {v.x, v.y, v.z}; }

/// The parts of an object have its name and its transform.
Json objects_of(const Scene& scene) {
    Json objects = Json::array();
    std::map<std::pair<std::string, std::size_t>, std::size_t> rows;
    for (std::size_t i = 0; i < scene.instances.size() && objects.size() < most_rows; ++i) {
        const MeshInstance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[instance.mesh];
        std::size_t place = 0;  // among objects of one name
        while (!instance.name.empty()) {
            const auto row = rows.find({instance.name, place});
            if (row == rows.end() ||
                scene.instances[objects[row->second]["instance"].get<std::size_t>()].transform == instance.transform)
                break;
            ++place;
        }
        const auto [row, is_new] = rows.try_emplace(
            instance.name.empty() ? std::pair(std::string(), i) : std::pair(instance.name, place), objects.size());
        if (is_new)
            objects.push_back({{"instance", i},
                               {"name", instance.name.empty() ? mesh.name : instance.name},
                               {"triangles", 0},
                               {"material", mesh.materials.empty() ? 0 : mesh.materials[0]}});
        Json& triangles = objects[row->second]["triangles"];
        triangles = triangles.get<std::size_t>() + mesh.triangles.size();
    }
    return objects;
}

template <class Thing, std::size_t triples, std::size_t numbers>
Json values_of(const Thing& thing, const TripleRow<Thing> (&of_three)[triples],
               const NumberRow<Thing> (&of_one)[numbers]) {
    Json values;
    for (const TripleRow<Thing>& row : of_three) values[row.name] = triple(thing.*row.member);
    for (const NumberRow<Thing>& row : of_one) values[row.name] = thing.*row.member;
    return values;
}

template <class Thing, std::size_t triples, std::size_t numbers>
Json rows_of(const TripleRow<Thing> (&of_three)[triples], const NumberRow<Thing> (&of_one)[numbers]) {
    Json rows = Json::array();
    for (const TripleRow<Thing>& row : of_three)
        rows.push_back({{"name", row.name}, {"kind", row.color ? "color" : "place"}, {"most", row.most}});
    for (const NumberRow<Thing>& row : of_one)
        rows.push_back({{"name", row.name}, {"kind", "number"}, {"least", row.least}, {"most", row.most}});
    return rows;
}

Json materials_of(const Scene& scene) {
    Json materials = Json::array();
    for (const Material& material : scene.materials) {
        if (materials.size() == most_rows) break;
        const MaterialKindRow* row = row_of(material.kind);
        materials.push_back({{"name", material.name},
                             {"kind", row ? row->name : "custom"},
                             {"values", values_of(material, material_triples, material_numbers)}});
    }
    return materials;
}

Json lights_of(const Scene& scene) {
    Json lights = Json::array();
    for (const Light& light : scene.lights) {
        if (lights.size() == most_rows) break;
        const LightTraits& traits = *traits_of(light.kind);
        lights.push_back({{"name", light.name},
                          {"kind", traits.name},
                          {"far", traits.far},
                          {"values", values_of(light, light_triples, light_numbers)}});
    }
    return lights;
}

/// With the cost as a share of a frame, once `explain` has measured it.
Json effects_of_view(const View& view) {
    std::map<Effect, const measure::ExplainedEffect*> measured;
    for (const measure::ExplainedEffect& effect : view.costs().explanation().effects) measured[effect.effect] = &effect;
    Json effects = Json::array();
    for (const EffectCause& cause : causes_of_effects(view.scene())) {
        Json row = {{"name", name_of(cause.effect)}, {"by", cause.first}, {"count", cause.count}};
        if (const auto found = measured.find(cause.effect); found != measured.end() && !found->second->fixed) {
            row["cost"] = 1 - found->second->ratio;
            row["noise"] = found->second->noise;
        }
        effects.push_back(row);
    }
    return effects;
}

Json camera_of_view(const Camera& camera) {
    return {{"position", triple(camera.position)},
            {"target", triple(camera.target)},
            {"up", triple(camera.up)},
            {"fov", camera.vertical_fov},
            {"aperture", camera.aperture_radius},
            {"focus", camera.focus_distance},
            {"height", camera.orthographic_height},
            {"projection", traits_of(camera.projection)->name},
            {"options", options_of(camera)}};
}

/// The directions of an object's own axes.
Json axes_of(const MeshInstance& instance) {
    Json axes;
    for (int i = 0; i < 3; ++i) axes.push_back(triple(glm::normalize(glm::vec3(instance.transform[i]))));
    return axes;
}

Json choices_of_command(const std::string& name) {
    for (const CommandRow& row : view_commands())
        if (row.name == name) return choices_of(row);
    return {};
}

std::string text_of(const Json& json) {
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);  // names of files may be no UTF-8
}

}  // namespace

std::string describe(const View& view, bool has_job) {
    const Scene& scene = view.scene();
    const ViewConfig& config = view.config();
    Json keys, curve = Json::array();
    for (const KeyRow& row : key_rows()) keys[row.key] = row.command;
    for (const CurvePoint& point : view.curve().points()) curve.push_back({point.seconds, point.spp, point.noise});
    const Bounds bounds = bounds_of(scene);
    return text_of({{"name", scene.name},
                    {"objects", objects_of(scene)},
                    {"instances", scene.instances.size()},
                    {"triangles", triangle_count(scene)},
                    {"materials", materials_of(scene)},
                    {"material_values", rows_of(material_triples, material_numbers)},
                    {"lights", lights_of(scene)},
                    {"light_values", rows_of(light_triples, light_numbers)},
                    {"effects", effects_of_view(view)},
                    {"size", bounds.empty() ? 1.f : glm::length(bounds.extent())},
                    {"spp", config.render.spp},
                    {"exposure", config.picture.exposure},
                    {"tone", config.picture.tone_map == ToneMap::none ? "none" : "aces"},
                    {"tones", choices_of_command("tone")},
                    {"shows", choices_of_command("show")},
                    {"animated", bool(config.animation.scene_at)},
                    {"animation_seconds", config.animation.seconds},
                    {"undo", view.history().to_undo()},
                    {"redo", view.history().to_redo()},
                    {"keys", keys},
                    {"key_help", key_help},
                    {"mouse", {{"degrees", degrees_per_pixel}, {"zoom", zoom_per_step}, {"click", farthest_click}}},
                    {"has_job", has_job},
                    {"run", view.state().run},
                    {"curve", curve}});
}

std::string describe_frame(const View& view, const Frame& frame, const Answer& told) {
    const ViewState state = view.state();
    const std::vector<CurvePoint>& curve = view.curve().points();
    const auto number_of = [](const auto& number) { return number ? Json(*number) : Json(nullptr); };
    return text_of({{"width", frame.width},
                    {"height", frame.height},
                    {"spp", frame.spp},
                    {"complete", frame.complete},
                    {"seconds", view.curve().seconds()},
                    {"noise", curve.empty() ? 0 : curve.back().noise},
                    {"run", state.run},
                    {"revision", state.revision},
                    {"shows", state.shows},
                    {"denoises", state.denoises},
                    {"paused", state.paused},
                    {"playing", state.playing},
                    {"spin", state.spin},
                    {"time", state.time},
                    {"instance", number_of(state.instance)},
                    {"material", number_of(state.material)},
                    {"light", number_of(state.light)},
                    {"pivot", state.pivot ? triple(*state.pivot) : Json(nullptr)},
                    {"axes", state.instance ? axes_of(view.scene().instances[*state.instance]) : Json(nullptr)},
                    {"camera", camera_of_view(view.camera())},
                    {"measures", view.costs().is_running()},
                    {"told", told.line.substr(0, most_letters)},
                    {"failed", told.failed}});
}

}  // namespace claray::view
