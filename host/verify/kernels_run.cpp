#include "host/verify/kernels_run.hpp"

#include <mutex>
#include <regex>

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
    : device_(device), wanted_(wanted), names_(names) {
    if (!wanted_) return;
    device_.profiler().keep_records(true);
    first_ = device_.profiler().records().size();
}

KernelsRun::~KernelsRun() {
    if (!wanted_) return;
    const std::vector<ProfileRecord>& records = device_.profiler().records();
    const std::set<std::string> kernels = kernel_names();
    const std::lock_guard lock(names_are_added);
    for (std::size_t i = first_; i < records.size(); ++i)
        if (kernels.contains(records[i].name)) names_.insert(records[i].name);
}

}  // namespace verify
}  // namespace claray
