#include "host/io/scene_textures.hpp"

#include <algorithm>
#include <cctype>

#include "claray/error.hpp"
#include "host/io/image/image_file.hpp"
#include "host/io/obj/obj_words.hpp"

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

constexpr std::size_t longest_name = 100;  // in messages

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const int letter = std::tolower(static_cast<unsigned char>(c));
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
    std::replace(name.begin(), name.end(), '\\', '/');
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
    if (last == std::string::npos || !(has_drive || name[0] == '/' || name[0] == '\\')) return {};
    const fs::path path = folder / name.substr(last + 1);
    std::error_code error;
    return path.has_filename() && fs::is_regular_file(path, error) ? path : fs::path();
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
