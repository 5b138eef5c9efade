#include "host/compute/drivers/icd.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>

#include "claray/error.hpp"
#include "claray/opencl.hpp"
#include "host/base/file.hpp"
#include "host/base/folders.hpp"
#include "host/base/hash.hpp"
#include "host/base/process/environment.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

Icd read_icd(const fs::path& file) {
    std::string library;
    std::getline(std::ifstream(file) >> std::ws, library);
    while (!library.empty() && std::strchr(" \t\r", library.back()) != nullptr) library.pop_back();
    return {file, library};
}

std::string name_of(const Icd& icd) { return "the driver '" + icd.library + "' of '" + icd.file.string() + "'"; }

/// All on which it depends whether drivers crash, as far as that is cheap to know.
std::string identity_of(const std::vector<Icd>& icds) {
    std::string text = "drivers that list their devices\n";
    for (const char* variable : {"OCL_ICD_VENDORS", "LD_LIBRARY_PATH", "LD_PRELOAD", "POCL_DEVICES"})
        text += environment(variable) + '\n';
    std::error_code none;
    for (const Icd& icd : icds)
        for (const fs::path& path : {icd.file, fs::path(icd.library)})
            text +=
                path.string() + ' ' + std::to_string(fs::last_write_time(path, none).time_since_epoch().count()) + '\n';
    return text;
}

fs::path note_of_passed() { return cache_folder() / "drivers.ok"; }

bool passed_before(const std::string& digest) {
    std::string noted;
    return !cache_folder().empty() && std::getline(std::ifstream(note_of_passed()), noted) && noted == digest;
}

void remember_as_passed(const std::string& digest) try {
    if (make_writable(cache_folder())) write_file(note_of_passed(), digest + '\n');
} catch (const Error&) {  // they will be asked again
}

/// In a child process that nobody hears.
[[noreturn]] void list_devices_and_exit() {
    constexpr unsigned seconds_before_it_hangs = 30;
    const struct rlimit no_core = {};
    ::setrlimit(RLIMIT_CORE, &no_core);
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
    for (const int signal_number : {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGALRM})
        std::signal(signal_number, SIG_DFL);
    ::alarm(seconds_before_it_hangs);
    cl_uint count = 0;
    cl_platform_id platforms[64];
    if (::clGetPlatformIDs(64, platforms, &count) != CL_SUCCESS) ::_exit(0);
    for (cl_uint i = 0; i < std::min(count, 64u); ++i) {
        cl_uint devices = 0;
        (void)::clGetDeviceIDs(platforms[i], CL_DEVICE_TYPE_ALL, 0, nullptr, &devices);
    }
    ::_exit(0);
}

/// Returns the signal that ended the child, or 0. With the drivers of `vendors` only, unless that is empty.
int signal_of_listing(const fs::path& vendors) {
    const pid_t child = ::fork();
    if (child < 0) return 0;
    if (child == 0) {
        if (!vendors.empty()) ::setenv("OCL_ICD_VENDORS", vendors.c_str(), 1);
        list_devices_and_exit();
    }
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return 0;
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

std::shared_ptr<const fs::path> folder_of(const std::vector<Icd>& icds) {
    const auto folder = scratch_folder();
    for (std::size_t i = 0; i < icds.size(); ++i)
        write_file(*folder / (std::to_string(i) + ".icd"), icds[i].library + '\n');
    return folder;
}

/// A process that uses a driver already cannot be forked any more, and needs no probe.
bool uses(const Icd& icd) {
    void* const library = ::dlopen(icd.library.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    if (library != nullptr) ::dlclose(library);
    return library != nullptr;
}

std::vector<std::string> crashing;
std::shared_ptr<const fs::path> others;  // the drivers that are used instead of all

/// Nothing if it finds platforms.
std::string failure_of(const Icd& icd) {
    void* const library = ::dlopen(icd.library.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (library == nullptr) return std::string("cannot be loaded: ") + ::dlerror();
    using Lookup = void*(const char*);
    using Platforms = cl_int(cl_uint, cl_platform_id*, cl_uint*);
    auto* const look_up = reinterpret_cast<Lookup*>(::dlsym(library, "clGetExtensionFunctionAddress"));
    if (look_up == nullptr) return "is no OpenCL driver";
    auto* const platforms = reinterpret_cast<Platforms*>(look_up("clIcdGetPlatformIDsKHR"));
    cl_uint count = 0;
    const cl_int gave = platforms != nullptr ? platforms(0, nullptr, &count) : CL_SUCCESS;
    if (gave == CL_SUCCESS) return {};
    return "finds no platform: clIcdGetPlatformIDsKHR gave " + std::to_string(gave);
}

}  // namespace

std::vector<Icd> installed_icds() {
    const std::string chosen = environment("OCL_ICD_VENDORS");
    const fs::path vendors = chosen.empty() ? "/etc/OpenCL/vendors" : chosen;
    std::error_code none;
    if (fs::is_regular_file(vendors, none)) return {read_icd(vendors)};
    std::vector<Icd> icds;
    for (const auto& entry : fs::directory_iterator(vendors, none))
        if (entry.path().extension() == ".icd") icds.push_back(read_icd(entry.path()));
    std::ranges::sort(icds, {}, &Icd::file);
    return icds;
}

void leave_out_crashing_drivers() {
    const std::vector<Icd> icds = installed_icds();
    const std::string digest = hash128(identity_of(icds));
    if (std::ranges::any_of(icds, uses) || passed_before(digest)) return;
    if (signal_of_listing({}) == 0) return remember_as_passed(digest);
    std::vector<Icd> good;
    for (const Icd& icd : icds) {
        const int ended_by = signal_of_listing(*folder_of({icd}));
        if (ended_by == 0)
            good.push_back(icd);
        else
            crashing.push_back(name_of(icd) + (ended_by == SIGALRM ? " hangs" : " crashes") +
                               " when it lists its devices");
    }
    others = folder_of(good);
    ::setenv("OCL_ICD_VENDORS", others->c_str(), 1);
}

const std::vector<std::string>& crashing_drivers() { return crashing; }

std::vector<std::string> failing_drivers() {
    std::vector<std::string> failing = crashing;
    for (const Icd& icd : installed_icds())
        if (const std::string why = failure_of(icd); !why.empty()) failing.push_back(name_of(icd) + ' ' + why);
    return failing;
}

}  // namespace claray
