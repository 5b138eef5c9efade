#include "host/denoise/oidn.hpp"

#include <cstdlib>

#include "claray/error.hpp"
#include "host/base/process/plugin.hpp"

namespace claray {
namespace {

// From the documentation of its C API (https://www.openimagedenoise.org/documentation.html), which is the same in
// versions 2.0 to 2.5.
constexpr int cpu_device = 1, three_floats = 3;
using Handle = void*;

std::string wanted_library() {
    const char* path = std::getenv("CLARAY_OIDN");
    return path && *path ? path : "";
}

void* open_library() {
    const std::string path = wanted_library();
    if (!path.empty()) return dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    for (const char* name : {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so"})
        if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
    return nullptr;
}

}  // namespace

struct Oidn::Functions {
    Handle (*new_device)(int type) = nullptr;
    void (*commit_device)(Handle) = nullptr;
    void (*release_device)(Handle) = nullptr;
    int (*device_error)(Handle, const char** message) = nullptr;
    Handle (*new_filter)(Handle device, const char* type) = nullptr;
    void (*set_image)(Handle filter, const char* name, void* pixels, int format, std::size_t width, std::size_t height,
                      std::size_t offset, std::size_t pixel_stride, std::size_t row_stride) = nullptr;
    void (*set_bool)(Handle filter, const char* name, bool value) = nullptr;
    void (*commit_filter)(Handle) = nullptr;
    void (*execute_filter)(Handle) = nullptr;
    void (*release_filter)(Handle) = nullptr;

    [[nodiscard]] bool found_in(void* library) {
        return find_function(library, "oidnNewDevice", new_device) &&
               find_function(library, "oidnCommitDevice", commit_device) &&
               find_function(library, "oidnReleaseDevice", release_device) &&
               find_function(library, "oidnGetDeviceError", device_error) &&
               find_function(library, "oidnNewFilter", new_filter) &&
               find_function(library, "oidnSetSharedFilterImage", set_image) &&
               find_function(library, "oidnSetFilterBool", set_bool) &&
               find_function(library, "oidnCommitFilter", commit_filter) &&
               find_function(library, "oidnExecuteFilter", execute_filter) &&
               find_function(library, "oidnReleaseFilter", release_filter);
    }
    void check(Handle device) const {
        const char* message = nullptr;
        if (device_error(device, &message) != 0)
            throw Error(ErrorKind::device, "Open Image Denoise failed: " + std::string(message ? message : "no reason"),
                        "use --denoise=claray");
    }
};

std::unique_ptr<Oidn> Oidn::load() {
    std::unique_ptr<Oidn> oidn(new Oidn);
    oidn->library_ = open_library();
    oidn->call_ = std::make_unique<Functions>();
    if (!oidn->library_ || !oidn->call_->found_in(oidn->library_)) return nullptr;
    oidn->device_ = oidn->call_->new_device(cpu_device);
    if (!oidn->device_) return nullptr;
    oidn->call_->commit_device(oidn->device_);
    oidn->call_->check(oidn->device_);
    return oidn;
}

std::unique_ptr<Oidn> Oidn::load_or_throw() {
    if (std::unique_ptr<Oidn> oidn = load()) return oidn;
    const std::string path = wanted_library();
    throw Error(ErrorKind::user,
                path.empty() ? "Open Image Denoise 2 is not installed (libOpenImageDenoise.so.2)"
                             : "$CLARAY_OIDN, '" + path + "', is not Open Image Denoise 2",
                "install it, set CLARAY_OIDN to the library's path, or use --denoise=claray");
}

/// The library itself stays loaded: its threads do not survive dlclose.
Oidn::~Oidn() {
    if (device_) call_->release_device(device_);
}

std::vector<glm::vec3> Oidn::denoise(OidnImages images) {
    std::vector<glm::vec3> result(images.color.size());
    const Handle filter = call_->new_filter(device_, "RT");
    const auto set = [&](const char* name, std::vector<glm::vec3>& pixels) {
        call_->set_image(filter, name, pixels.data(), three_floats, images.width, images.height, 0, 0, 0);
    };
    set("color", images.color), set("albedo", images.albedo), set("normal", images.normal), set("output", result);
    call_->set_bool(filter, "hdr", true);
    call_->commit_filter(filter);
    call_->execute_filter(filter);
    call_->release_filter(filter);
    call_->check(device_);
    return result;
}

}  // namespace claray
