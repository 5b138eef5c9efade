#include <algorithm>
#include <cmath>

#include "claray/error.hpp"
#include "host/base/did_you_mean.hpp"
#include "host/base/format.hpp"
#include "host/io/default_light.hpp"
#include "host/io/scene_readers.hpp"

namespace claray {

namespace {

/// "glTF and FBX": the formats that know a choice.
std::string formats_with(bool SceneChoices::*choice) {
    std::string names;
    for (const SceneReader& reader : scene_readers())
        if (reader.load && reader.choices.*choice) names += std::string(names.empty() ? "" : " and ") + reader.name;
    return names;
}

/// Throws where something is chosen of what holds no choice.
void refuse_choices(const std::string& name, const LoadOptions& options, const SceneChoices& known) {
    const auto refuse = [&](bool chosen, bool SceneChoices::*choice, const char* what) {
        if (chosen && !(known.*choice))
            throw Error(ErrorKind::usage, "'" + name + "' has no " + what + " to choose from",
                        "leave this option out, only " + formats_with(choice) + " files have them");
    };
    refuse(options.time.has_value() || !options.animation.empty(), &SceneChoices::animations, "animations");
    refuse(!options.variant.empty(), &SceneChoices::variants, "material variants");
    refuse(!options.camera.empty(), &SceneChoices::cameras, "cameras");
    refuse(!options.scene.empty(), &SceneChoices::scenes, "scenes");
    if (options.stroke_radius && !known.stroke_radius)
        throw Error(ErrorKind::usage, "'" + name + "' has no points or lines with a radius", "leave this option out");
}

/// The built-in scenes, with the number or the name that `name` has behind its colon.
std::vector<std::string> names_like(const std::string& name) {
    const std::size_t colon = std::min(name.find(':'), name.size());
    std::vector<std::string> names;
    for (const std::string builtin : builtin_scene_names()) {
        const std::size_t end = builtin.find(':');
        names.push_back(builtin.substr(0, end) + (end == std::string::npos ? "" : name.substr(colon)));
    }
    return names;
}

[[noreturn]] void refuse_unknown(const std::string& name) {
    std::error_code unreadable;
    if (std::filesystem::is_regular_file(name, unreadable))
        throw Error(ErrorKind::user, "'" + name + "' is none of the files that claray reads: " + scene_format_names(),
                    "convert it to one of these");
    std::string known;
    for (const char* builtin : builtin_scene_names()) known += std::string(known.empty() ? "" : ", ") + builtin;
    throw Error(ErrorKind::usage, "unknown scene '" + name + "'" + did_you_mean(name, names_like(name)),
                "give the path of a scene file or one of " + known);
}

bool has_light(const Scene& scene) {
    const bool sky = scene.sky.horizon != glm::vec3(0.f) || scene.sky.zenith != glm::vec3(0.f);
    return sky || !scene.lights.empty() || !scene.environment.images.empty() ||
           std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.emission != glm::vec3(0.f); });
}

/// A file that does not exist is left to the reader, whose error says so.
LoadedScene load_file(const std::string& name, Warnings& warnings, const LoadOptions& options) {
    const SceneReader* reader = scene_reader_of(name);
    if (!reader) refuse_unknown(name);
    if (!reader->load)
        throw Error(ErrorKind::user, "'" + name + "' is " + reader->name + ", which claray does not read",
                    reader->remedy);
    std::error_code unreadable;
    if (std::filesystem::exists(name, unreadable)) refuse_choices(name, options, reader->choices);
    LoadedScene loaded{reader->load(name, warnings, options)};
    loaded.is_file = !(reader->states_light && has_light(loaded.scene));
    return loaded;
}

/// Warns of coordinates far from the origin, as maps have them, which float32 rounds to coarse steps.
void warn_of_rounding(const Scene& scene, const std::string& name, Warnings& warnings) {
    constexpr double most = 1e-5;  // of the extent
    const Bounds bounds = bounds_of(scene);
    if (bounds.empty()) return;
    const auto largest = [](const glm::vec3& v) { return double(std::max({v.x, v.y, v.z})); };
    const double extent = largest(bounds.extent());
    const double farthest = largest(glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi)));
    const double rounding = std::exp2(std::floor(std::log2(farthest)) - 24);
    if (extent > 0 && rounding > most * extent)
        warnings.push_back("'" + name + "': coordinates reach " +
                           printed("%.6g, where float32 rounds them by up to %.2g, and their extent is %.3g", farthest,
                                   rounding, extent) +
                           "; move the scene to the origin in the program that wrote the file");
}

}  // namespace

std::optional<double> animation_seconds(const std::string& name_or_path, const LoadOptions& options) {
    if (builtin_scene(name_or_path)) return {};
    const SceneReader* reader = scene_reader_of(name_or_path);
    if (!reader || !reader->animation_seconds) return {};
    return reader->animation_seconds(name_or_path, options);
}

LoadedScene load_without_light(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    if (std::optional<Scene> scene = builtin_scene(name_or_path)) {
        refuse_choices(name_or_path, options, {});
        return {*std::move(scene), false};
    }
    LoadedScene loaded = load_file(name_or_path, warnings, options);
    warn_of_rounding(loaded.scene, name_or_path, warnings);
    return loaded;
}

}  // namespace claray
