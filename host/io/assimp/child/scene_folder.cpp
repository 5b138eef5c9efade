#include "host/io/assimp/child/scene_folder.hpp"

#include <assimp/MemoryIOWrapper.h>
#include <algorithm>
#include <fstream>
#include <string_view>

#include "host/io/words.hpp"

namespace claray::assimp {
namespace {

namespace fs = std::filesystem;

bool is_below(const fs::path& path, const fs::path& folder) {
    const auto [end, other] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    return end == folder.end();
}

/// The bytes, which a stream of Assimp owns; null if they cannot be read.
Assimp::IOStream* open_bytes(const fs::path& path) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    std::ifstream stream(path, std::ios::binary);
    if (error || !stream) return nullptr;
    auto* const bytes = new std::uint8_t[size];
    stream.read(reinterpret_cast<char*>(bytes), std::streamsize(size));
    return new Assimp::MemoryIOStream(bytes, std::size_t(stream.gcount()), true);
}

}  // namespace

SceneFolder::SceneFolder(const fs::path& file, const std::string& format)
    : file_(file),
      folder_(fs::weakly_canonical(file.parent_path().empty() ? "." : file.parent_path())),
      scene_("scene." + format) {
    list(folder_, true);
}

void SceneFolder::list(const fs::path& folder, bool also_below) {
    constexpr std::size_t most = 20'000;
    std::error_code error;
    std::vector<fs::path> below;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end && files_.size() < most;
         entry.increment(error)) {
        std::error_code unreadable;
        if (entry->is_directory(unreadable))
            below.push_back(entry->path());
        else
            files_.try_emplace(lower_case(entry->path().filename().string()),
                               entry->path().lexically_relative(folder_).string());
    }
    if (!also_below) return;
    std::sort(below.begin(), below.end());
    for (const fs::path& path : below) list(path, false);
}

std::optional<std::string> SceneFolder::find(const std::string& name) const {
    std::string slashes = name;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    const fs::path asked(slashes);
    std::error_code error;
    if (asked.is_relative() && fs::is_regular_file(folder_ / asked, error) &&
        is_below(fs::weakly_canonical(folder_ / asked, error), folder_))
        return asked.lexically_normal().string();
    const auto found = files_.find(lower_case(asked.filename().string()));
    return found == files_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<fs::path> SceneFolder::path_of(const std::string& name) const {
    if (name == scene_) return file_;
    const std::optional<std::string> found = find(name);
    return found ? std::optional(folder_ / *found) : std::nullopt;
}

Assimp::IOStream* SceneFolder::Open(const char* name, const char* mode) {
    const std::optional<fs::path> path = path_of(name);
    return path && std::string_view(mode).starts_with('r') ? open_bytes(*path) : nullptr;
}

void SceneFolder::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace claray::assimp
