#include "host/base/folders.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "claray/error.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

/// By the specification paths that are not absolute are ignored.
fs::path xdg_folder(const char* variable, const char* below_home) {
    if (const char* folder = std::getenv(variable); folder != nullptr && *folder == '/') return folder;
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') return fs::path(home) / below_home;
    return {};
}

}  // namespace

bool make_writable(const fs::path& folder) {
    if (folder.empty()) return false;
    std::error_code error;
    const fs::path parent = folder.parent_path();
    if (!fs::is_directory(folder, error)) {
        if (parent != folder && !parent.empty() && !fs::is_directory(parent, error))
            fs::create_directories(parent, error);
        ::mkdir(folder.c_str(), 0700);
    }
    return fs::is_directory(folder, error) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

fs::path cache_folder() {
    if (const char* folder = std::getenv("CLARAY_CACHE_DIR"); folder != nullptr && *folder != '\0') return folder;
    const fs::path folder = xdg_folder("XDG_CACHE_HOME", ".cache");
    return folder.empty() ? folder : folder / "claray";
}

fs::path log_folder() {
    const fs::path state = xdg_folder("XDG_STATE_HOME", ".local/state");
    if (!state.empty() && make_writable(state / "claray")) return state / "claray";
    if (const fs::path cache = cache_folder(); make_writable(cache)) return cache;
    std::error_code none;
    return user_folder_in(fs::temp_directory_path(none));
}

fs::path user_folder_in(const fs::path& temporary) {
    if (temporary.empty()) return {};
    const fs::path folder = temporary / ("claray-" + std::to_string(::geteuid()));
    ::mkdir(folder.c_str(), 0700);
    struct stat found = {};
    const bool is_ours = ::lstat(folder.c_str(), &found) == 0 && S_ISDIR(found.st_mode) &&
                         found.st_uid == ::geteuid() && (found.st_mode & 077) == 0;
    if (is_ours) return folder;
    std::string name = folder.string() + "-XXXXXX";
    return ::mkdtemp(name.data()) != nullptr ? fs::path(name) : fs::path();
}

std::shared_ptr<const fs::path> scratch_folder() {
    std::string name = (fs::temp_directory_path() / "claray-XXXXXX").string();
    if (!::mkdtemp(name.data()))
        throw Error(ErrorKind::user, "cannot create the folder " + name, "set TMPDIR to a writable folder");
    return {new fs::path(name), [](const fs::path* path) {
                std::error_code none;
                fs::remove_all(*path, none);
                delete path;
            }};
}

}  // namespace claray
