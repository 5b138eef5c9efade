#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/io/default_light.hpp"
#include "host/io/words.hpp"

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
}

/// Of what has neither points nor lines.
void refuse_radius(const std::string& name, const LoadOptions& options) {
    if (options.stroke_radius)
        throw Error(ErrorKind::usage, "'" + name + "' has no points or lines with a radius", "leave this option out");
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

enum class Format { unknown, obj, ply, stl, gltf };

/// The beginning of a regular file, empty for anything else.
std::string beginning_of(const std::filesystem::path& path) {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(path, unreadable)) return {};
    std::string bytes(std::size_t(1) << 16, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), std::streamsize(bytes.size()));
    bytes.resize(std::size_t(file.gcount()));
    return bytes;
}

/// A statement of an OBJ, before anything that is none.
bool begins_like_obj(std::string_view text) {
    constexpr std::array<std::string_view, 10> statements = {"v", "vt", "vn",     "f",      "g",
                                                             "o", "s",  "usemtl", "mtllib", "l"};
    for (std::size_t end = 0; !text.empty(); text.remove_prefix(std::min(end + 1, text.size()))) {
        end = std::min(text.find_first_of("\r\n"), text.size());
        std::string_view line = text.substr(0, end);
        const std::string_view word = next_word(line);
        if (!word.empty()) return std::find(statements.begin(), statements.end(), word) != statements.end();
    }
    return false;
}

/// A binary STL has no mark but its size: 84 bytes, and 50 for each triangle.
bool has_size_of_stl(std::string_view beginning, std::uintmax_t size) {
    if (beginning.size() < 84) return false;
    std::uintmax_t triangles = 0;
    for (std::size_t i = 4; i-- > 0;) triangles = triangles << 8 | std::uint8_t(beginning[80 + i]);
    return size == 84 + 50 * triangles;
}

Format format_by_content(const std::filesystem::path& path) {
    const std::string bytes = beginning_of(path);
    std::string_view text = bytes;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    if (text.starts_with("glTF") || text.starts_with('{')) return Format::gltf;
    if (text.starts_with("ply\n") || text.starts_with("ply\r")) return Format::ply;
    if (bytes.empty()) return Format::unknown;
    if (text.starts_with("solid") || has_size_of_stl(bytes, std::filesystem::file_size(path))) return Format::stl;
    return begins_like_obj(text) ? Format::obj : Format::unknown;
}

/// By the extension; other files, such as .vrm and files without one, by their first bytes.
Format format_of(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".obj") return Format::obj;
    if (extension == ".ply") return Format::ply;
    if (extension == ".stl") return Format::stl;
    if (extension == ".gltf" || extension == ".glb") return Format::gltf;
    return format_by_content(path);
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

LoadedScene load(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    if (std::optional<Scene> scene = builtin_scene(name_or_path)) {
        refuse_choice(name_or_path, options);
        refuse_radius(name_or_path, options);
        return {*std::move(scene), false};
    }
    const std::filesystem::path path(name_or_path);
    const Format format = format_of(path);
    if (format == Format::gltf) return {load_gltf_without_light(path, warnings, options), true};
    if (format != Format::unknown) refuse_choice_of_file(path, options);
    if (format == Format::obj) return {load_obj_without_light(path, warnings, options), true};
    if (format == Format::ply) return {load_ply_without_light(path, warnings, options), true};
    if (format == Format::stl) {
        refuse_radius(name_or_path, options);
        return {load_stl_without_light(path, warnings), true};
    }

    std::error_code unreadable;
    if (std::filesystem::is_regular_file(path, unreadable))
        throw Error(ErrorKind::user, "'" + name_or_path + "' is neither OBJ, PLY, STL nor glTF",
                    "convert it to one of these");
    std::string known;
    for (const char* name : builtin_scene_names()) known += std::string(known.empty() ? "" : ", ") + name;
    throw Error(ErrorKind::usage, "unknown scene '" + name_or_path + "'",
                "give a .obj, .ply, .stl, .gltf or .glb file or one of " + known);
}

}  // namespace

std::optional<double> animation_seconds(const std::string& name_or_path, const LoadOptions& options) {
    if (builtin_scene(name_or_path) || format_of(name_or_path) != Format::gltf) return {};
    return gltf_animation_seconds(name_or_path, options);
}

LoadedScene load_without_light(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options) {
    LoadedScene loaded = load(name_or_path, warnings, options);
    if (loaded.is_file) warn_of_rounding(loaded.scene, name_or_path, warnings);
    return loaded;
}

}  // namespace claray
