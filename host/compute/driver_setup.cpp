#include "host/compute/driver_setup.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>

#include "claray/error.hpp"
#include "host/base/folders.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

const char* value_of(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : "";
}

/// PoCL's default (lib/CL/pocl_cache.c, 3.1 to 6.0): in $XDG_CACHE_HOME or ~/.cache. Without these it takes /tmp/pocl,
/// where other users could place programs: unusable.
fs::path default_pocl_folder() {
    fs::path folder = value_of("XDG_CACHE_HOME");
    if (folder.empty() && *value_of("HOME") != '\0') folder = fs::path(value_of("HOME")) / ".cache";
    return folder.empty() ? folder : folder / "pocl" / "kcache";
}

/// Returns false if there is no folder to which PoCL could write.
bool give_pocl_a_folder() {
    const fs::path chosen = value_of("POCL_CACHE_DIR");
    if (!chosen.empty()) {
        if (make_writable(chosen)) return true;
        throw Error(ErrorKind::user, "POCL_CACHE_DIR is '" + chosen.string() + "', which is not writable",
                    "set it to a writable folder");
    }
    ::unsetenv("POCL_CACHE_DIR");  // PoCL 3.1 aborts if it is set and empty
    if (make_writable(default_pocl_folder())) return true;
    const fs::path own = pocl_folder();
    return !own.empty() && ::setenv("POCL_CACHE_DIR", own.c_str(), 1) == 0;
}

void give_threads_a_stack() {
#ifdef __GLIBC__
    constexpr std::size_t needed = std::size_t(8) << 20;
    pthread_attr_t attributes;
    std::size_t now = 0;
    if (::pthread_getattr_default_np(&attributes) != 0) return;
    if (::pthread_attr_getstacksize(&attributes, &now) == 0 && now < needed &&
        ::pthread_attr_setstacksize(&attributes, needed) == 0)
        ::pthread_setattr_default_np(&attributes);
    ::pthread_attr_destroy(&attributes);
#endif
}

bool pocl_can_write = true;

}  // namespace

void set_up_drivers() {
    static std::once_flag once;
    std::call_once(once, [] {
        pocl_can_write = give_pocl_a_folder();
        give_threads_a_stack();
    });
}

std::string no_device_remedy() {
    if (!pocl_can_write) return "PoCL has no writable folder: set POCL_CACHE_DIR, HOME or TMPDIR to a writable folder";
    return "install a driver, for example for CPUs: apt-get install pocl-opencl-icd";
}

}  // namespace claray
