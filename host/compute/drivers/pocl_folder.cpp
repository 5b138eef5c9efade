#include "host/compute/drivers/pocl_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "claray/error.hpp"
#include "host/base/folders.hpp"
#include "host/base/process/environment.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

constexpr const char* prefix = "claray-process-";

fs::path path_in(const char* variable) { return environment(variable); }

/// PoCL's default (lib/CL/pocl_cache.c, 3.1 to 6.0). Without these variables it takes /tmp/pocl, where other users
/// could place programs: unusable.
fs::path default_folder() {
    fs::path folder = path_in("XDG_CACHE_HOME");
    if (folder.empty() && !path_in("HOME").empty()) folder = path_in("HOME") / ".cache";
    return folder.empty() ? folder : folder / "pocl" / "kcache";
}

/// Whether PoCL's compiler gets the path in one piece.
bool survives_unquoted(const fs::path& path) {
    return fs::absolute(path).native().find_first_of(" \t\n\v\f\r\"'\\") == std::string::npos;
}

fs::path in_temporary_folder() {
    std::error_code error;
    const fs::path temporary = fs::temp_directory_path(error);
    const fs::path own = user_folder_in(error || survives_unquoted(temporary) ? temporary : fs::path("/tmp"));
    return own.empty() ? own : own / "pocl";
}

bool has_space(const fs::path& folder, std::uintmax_t bytes) {
    std::error_code error;
    const fs::space_info space = fs::space(folder, error);
    return error || space.available >= bytes;
}

bool is_own(const fs::path& folder) { return folder.filename().string().starts_with(prefix); }

/// Opens a folder and locks it until this process ends; -1 if another process has it.
int lock(const fs::path& folder) {
    const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0 || ::flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    ::close(file);
    return -1;
}

/// Removes the folders of processes that were killed. One that is new may not be locked yet.
void remove_left_behind(const fs::path& parent) {
    constexpr std::chrono::minutes new_for(1);
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(parent, none)) {
        if (!is_own(entry.path())) continue;
        const auto age = fs::file_time_type::clock::now() - entry.last_write_time(none);
        const int file = age > new_for ? lock(entry.path()) : -1;
        if (file < 0) continue;
        fs::remove_all(entry.path(), none);
        ::close(file);
    }
}

fs::path own_folder;
pid_t owner;

/// A forked process leaves it to its parent.
void remove_own_folder() {
    std::error_code none;
    if (::getpid() == owner) fs::remove_all(own_folder, none);
}

/// In a folder; returns false if that is not possible.
bool make_own_folder(const fs::path& parent) {
    constexpr std::uintmax_t enough = 32 << 20;  // for the kernels of most scenes
    if (parent.empty() || !survives_unquoted(parent) || !make_writable(parent) || !has_space(parent, enough))
        return false;
    remove_left_behind(parent);
    std::string name = (fs::absolute(parent) / prefix).native() + "XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) return false;
    (void)lock(name);
    own_folder = name, owner = ::getpid();
    std::atexit(remove_own_folder);
    return ::setenv("POCL_CACHE_DIR", name.c_str(), 1) == 0;
}

}  // namespace

bool pocl_disk_is_full() {
    constexpr std::uintmax_t least = 1 << 20;
    return !own_folder.empty() && !has_space(own_folder, least);
}

bool give_pocl_a_folder() {
    fs::path chosen = path_in("POCL_CACHE_DIR");
    if (is_own(chosen)) chosen = chosen.parent_path();  // that of the process which started this one
    if (!chosen.empty() && !make_writable(chosen))
        throw Error(ErrorKind::user, "POCL_CACHE_DIR is '" + chosen.string() + "', which is not writable",
                    "set it to a writable folder");
    ::unsetenv("POCL_CACHE_DIR");  // PoCL 3.1 aborts if it is set and empty
    const fs::path cache = cache_folder();
    return make_own_folder(chosen) || make_own_folder(default_folder()) ||
           make_own_folder(cache.empty() ? cache : cache / "pocl") || make_own_folder(in_temporary_folder());
}

}  // namespace claray
