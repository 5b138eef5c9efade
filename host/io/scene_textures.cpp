#include "host/io/scene_textures.hpp"

#include <algorithm>
#include <cctype>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/image/image_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

/// "https:", "file:", and "C:" of a drive: a scheme is a letter, then letters, digits, '+', '-', '.' (RFC 3986, 3.1).
bool has_scheme(const std::string& name) {
    const std::size_t colon = name.find(':');
    if (colon == std::string::npos || !std::isalpha(static_cast<unsigned char>(name[0]))) return false;
    return std::all_of(name.begin(), name.begin() + std::ptrdiff_t(colon),
                       [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

/// True where `path`, links followed, is in `root` or below.
bool is_below(const fs::path& root, const fs::path& path) {
    const fs::path inner = fs::weakly_canonical(path), outer = fs::weakly_canonical(root);
    return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

/// Backslashes part folders where many files come from.
std::string with_slashes(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return name;
}

bool is_file(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error);
}

constexpr std::size_t longest_name = 100;  // in messages

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const char letter = lower_case(c);
    return letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

}  // namespace

fs::path path_in_scene(const fs::path& root, const fs::path& folder, std::string name, const fs::path& named_in) {
    const auto refuse = [&](const std::string& why) {
        const fs::path at_fault = !named_in.empty() ? named_in : !root.empty() ? root : fs::path(".");
        throw Error(ErrorKind::user,
                    "'" + at_fault.string() + "': the file name " + quoted(name, longest_name) + " " + why,
                    "use a file in the scene's folder or below");
    };
    if (name.empty()) refuse("is empty");
    if (name.find('\0') != std::string::npos) refuse("contains a zero byte");
    if (has_scheme(name)) refuse("is a URL or contains a drive");
    name = with_slashes(std::move(name));
    if (name[0] == '/') refuse("is absolute");
    const fs::path base = root.empty() ? fs::path(".") : root;
    fs::path path = (folder.empty() ? fs::path(".") : folder) / name;
    try {
        if (!is_below(base, path)) refuse("leaves the scene's folder");
    } catch (const fs::filesystem_error& error) {
        refuse("cannot be resolved (" + error.code().message() + ")");
    }
    return path;
}

fs::path namesake_of(const fs::path& folder, const std::string& name) {
    const bool has_drive = name.size() > 2 && std::isalpha(static_cast<unsigned char>(name[0])) && name[1] == ':';
    const std::size_t last = name.find_last_of("/\\");
    if (last == std::string::npos || name.find('\0') != std::string::npos) return {};
    const bool absolute = has_drive || name[0] == '/' || name[0] == '\\';
    if (!absolute && (has_scheme(name) || is_file(folder / with_slashes(name)))) return {};
    const fs::path path = folder / name.substr(last + 1);
    return path.has_filename() && is_file(path) ? path : fs::path();
}

std::string remark_of_namesake(const fs::path& scene, const std::string& name, const fs::path& namesake) {
    const bool absolute = name.starts_with('/') || name.starts_with('\\') || has_scheme(name);
    return "'" + scene.string() + "': " + quoted(name, longest_name) +
           (absolute ? " is a path on another machine: '" : " is missing: '") + namesake.string() + "' is used instead";
}

std::optional<ImageFile> read_image_of_scene(const fs::path& scene, const fs::path& folder, const std::string& name,
                                             Warnings& warnings) {
    const fs::path namesake = namesake_of(folder, name);
    fs::path path;
    try {
        path =
            path_in_scene(scene.parent_path(), folder, namesake.empty() ? name : namesake.filename().string(), scene);
    } catch (const Error& error) {
        warnings.push_back(std::string(error.what()) + ": what the image would colour is grey");
        return {};
    }
    if (!is_file(path)) {
        warnings.push_back("'" + scene.string() + "': the image " + quoted(name, longest_name) +
                           " is missing, and what it would colour is grey: put it next to the file that names it");
        return {};
    }
    if (!namesake.empty()) warnings.push_back(remark_of_namesake(scene, name, namesake));
    return ImageFile{"'" + path.string() + "'", read_file(path, "check its permissions")};
}

void show_missing(Material& material) {
    if (!material.albedo_map.used()) material.albedo *= 0.5f;
}

std::string percent_decoded(const std::string& uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        text += low >= 0 ? char(high * 16 + low) : uri[i];
        if (low >= 0) i += 2;
    }
    return text;
}

void SceneTextures::keep(Texture texture, const TextureSettings& settings) {
    texture.wrap_u = settings.wrap_u, texture.wrap_v = settings.wrap_v, texture.filter = settings.filter;
    room_ -= std::min(room_, size_of(texture));
    scene_.textures.push_back(std::move(texture));
}

}  // namespace claray
