#include "host/verify/kernels_run.hpp"

#include <mutex>
#include <regex>

#include "host/compute/device_state.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {

namespace {

std::set<std::string> declared_kernels() {
    // "kernel", attributes and macros, "void", and the name; not in a comment.
    const std::regex declaration(R"((?:^|\n)(?:__)?kernel\b[^;{/]*?\bvoid\s+(\w+)\s*\()");
    std::set<std::string> names;
    for (const KernelSource& source : kernel_sources()) {
        const std::sregex_iterator end;
        for (std::sregex_iterator at(source.text.begin(), source.text.end(), declaration); at != end; ++at)
            names.insert((*at)[1]);
    }
    return names;
}

}  // namespace

std::set<std::string> kernel_names() {
    static const std::set<std::string> names = declared_kernels();  // each case asks for them
    return names;
}

namespace verify {
namespace {

std::mutex names_are_added;  // cases run pieces side by side

}  // namespace

KernelsRun::KernelsRun(const Device& device, bool wanted, std::set<std::string>& names)
    : device_(device), wanted_(wanted), names_(names), before_(state_of(device).kernels_run) {
    if (wanted_) state_of(device_).kernels_run = &run_;
}

KernelsRun::~KernelsRun() {
    if (!wanted_) return;
    state_of(device_).kernels_run = before_;
    const std::set<std::string> kernels = kernel_names();
    const std::lock_guard lock(names_are_added);
    for (const std::string& name : run_)
        if (kernels.contains(name)) names_.insert(name);
}

}  // namespace verify
}  // namespace claray
