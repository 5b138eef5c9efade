#include <algorithm>
#include <cctype>
#include <cmath>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/io/default_light.hpp"

namespace claray {

namespace {

/// Throws where something is chosen of what holds no choice.
void refuse_choice(const std::string& name, const LoadOptions& options) {
    const auto refuse = [&](bool chosen, const char* what) {
        if (chosen)
            throw Error(ErrorKind::usage, "'" + name + "' has no " + what + " to choose from",
                        "leave this option out, only glTF files have them");
    };
    refuse(options.time.has_value() || !options.animation.empty(), "animations");
    refuse(!options.variant.empty(), "material variants");
    refuse(!options.camera.empty(), "cameras");
    refuse(!options.scene.empty(), "scenes");
    refuse(options.stroke_radius.has_value(), "points or lines with a radius");
}

/// A file that does not exist is left to the reader, whose error says so.
void refuse_choice_of_file(const std::filesystem::path& path, const LoadOptions& options) {
    std::error_code unreadable;
    if (std::filesystem::exists(path, unreadable)) refuse_choice(path.string(), options);
}

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return extension;
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

bool is_gltf(const std::string& extension) { return extension == ".gltf" || extension == ".glb"; }

LoadedScene load(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    if (std::optional<Scene> scene = builtin_scene(name_or_path)) {
        refuse_choice(name_or_path, options);
        return {*std::move(scene), false};
    }
    const std::filesystem::path path(name_or_path);
    const std::string extension = extension_of(path);
    if (extension == ".obj") {
        refuse_choice_of_file(path, options);
        return {load_obj_without_light(path, warnings), true};
    }
    if (extension == ".ply" || extension == ".stl") {
        refuse_choice_of_file(path, options);
        return {extension == ".ply" ? load_ply_without_light(path, warnings) : load_stl_without_light(path, warnings),
                true};
    }
    if (is_gltf(extension)) return {load_gltf_without_light(path, warnings, options), true};

    std::error_code unreadable;
    if (std::filesystem::is_regular_file(path, unreadable))
        throw Error(ErrorKind::user, "'" + name_or_path + "' is not a .obj, .ply, .stl, .gltf or .glb file",
                    "convert it to one of these");
    std::string known;
    for (const char* name : builtin_scene_names()) known += std::string(known.empty() ? "" : ", ") + name;
    throw Error(ErrorKind::usage, "unknown scene '" + name_or_path + "'",
                "give a .obj, .ply, .stl, .gltf or .glb file or one of " + known);
}

}  // namespace

std::optional<double> animation_seconds(const std::string& name_or_path, const LoadOptions& options) {
    if (builtin_scene(name_or_path) || !is_gltf(extension_of(name_or_path))) return {};
    return gltf_animation_seconds(name_or_path, options);
}

LoadedScene load_without_light(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    LoadedScene loaded = load(name_or_path, warnings, options);
    if (loaded.is_file) warn_of_rounding(loaded.scene, name_or_path, warnings);
    return loaded;
}

}  // namespace claray
