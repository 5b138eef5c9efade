#include "claray/verify.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <numeric>

#include "host/base/seconds_since.hpp"
#include "host/verify/apart/run_apart.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/kernels_run.hpp"
#include "host/verify/run.hpp"

namespace claray {
namespace {

using namespace verify;

const Cases& entries() {
    static const Cases all = [] {
        Cases joined;
        for (const auto& family :
             {device_cases,      function_cases, edge_cases,       triangle_cases,  box_cases,       tree_cases,
              refit_cases,       instance_cases, query_cases,      primitive_cases, sensor_cases,    material_cases,
              media_cases,       image_cases,    harmonics_cases,  shading_cases,   gbuffer_cases,   wave_cases,
              random_cases,      light_cases,    near_light_cases, sameness_cases,  committed_cases, drawn_cases,
              drawn_query_cases, probe_cases})
            for (const Case& one : family()) joined.push_back(one);
        return joined;
    }();
    return all;
}

const Case& entry_of(const std::string& name) {
    for (const Case& entry : entries())
        if (entry.about.name == name) return entry;
    std::string names;
    for (const Case& entry : entries()) names += (names.empty() ? "" : ", ") + entry.about.name;
    throw Error(ErrorKind::usage, "unknown case '" + name + "'", "choose one of " + names);
}

VerifyResult run_case(const Device& device, Devices& more, const std::string& name, const VerifyOptions& options) {
    const Case& entry = entry_of(name);
    VerifyResult result;
    result.name = name, result.seed = options.seed;
    result.command = command_of(name, options, device.info());
    const auto begin = std::chrono::steady_clock::now();
    verify::Run run(device, more, options, result);
    try {
        const KernelsRun kernels(device, options.kernels, result.kernels);
        with_guards(device, [&] { entry.run(run); });
    } catch (const std::exception& error) {  // a driver without something that the case needs, or with an error
        const std::string what = error.what();
        return unended(name, options, device.info(), what.substr(0, what.find('\n')), seconds_since(begin));
    }
    result.seconds = seconds_since(begin);
    return result;
}

/// A smaller number for cases that compile longer: nan-pixels renders with all effects at once.
int rank_of(const std::string& name) {
    const std::string family = entry_of(name).about.family;
    return name == "nan-pixels" ? 0 : family == "images" || family == "materials" ? 1 : 2;
}

/// A CPU driver already has a thread per processor. GPUs wait for compilers, and not every driver may be asked by
/// several threads: Oclgrind mixes up the results of two contexts.
unsigned threads_for(const Device& device, const VerifyOptions& options) {
    if (options.threads != 0) return options.threads;
    if (device.info().type != DeviceType::gpu) return 1;
    return device.tuning("compute/programs", "SIDE_BY_SIDE") != 0 ? contexts_at_once() : 1;
}

VerifyOptions with_threads(const Device& device, VerifyOptions options) {
    options.threads = threads_for(device, options);
    return options;
}

}  // namespace

namespace verify {

bool measures_times(const std::string& name) { return entry_of(name).measures_times; }

std::string command_of(const std::string& name, const VerifyOptions& options, const DeviceInfo& device) {
    return "claray verify --case " + name + (options.effort == Effort::full ? " --full" : " --quick") + " --seed " +
           std::to_string(options.seed) + " --device '" + std::to_string(device.index) + "'";
}

void run_numbered_cases(const Device& device, std::span<const std::string> names, std::span<const std::size_t> which,
                        const VerifyOptions& with, const CaseEvents& events) {
    const VerifyOptions options = with_threads(device, with);
    std::vector<std::size_t> at_once, alone;
    for (const std::size_t i : which) {
        const bool measures = options.times && measures_times(names[i]);
        (options.threads > 1 && !measures ? at_once : alone).push_back(i);
    }
    std::ranges::stable_sort(at_once, {}, [&](std::size_t i) { return rank_of(names[i]); });
    Devices more(device);
    std::mutex mutex;
    bool ends = false;  // an event threw
    const auto tell = [&](const auto& event) {
        const std::lock_guard lock(mutex);
        if (ends) return false;
        ends = true;
        event();
        ends = false;
        return true;
    };
    const auto run = [&](const Device& on, std::size_t i) {
        bool begins = false;
        if (!tell([&] { begins = events.begun(i); }) || !begins) return;
        const VerifyResult result = run_case(on, more, names[i], options);
        (void)tell([&] { events.ended(i, result); });
    };
    side_by_side(device, more, options.threads, at_once.size(),
                 [&](const Device& on, std::size_t k) { run(on, at_once[k]); });
    for (const std::size_t i : alone) run(device, i);
}

}  // namespace verify

bool VerifyResult::holds() const {
    return std::all_of(checks.begin(), checks.end(), [](const VerifyCheck& c) { return c.holds(); });
}

const std::vector<VerifyCase>& verify_cases() {
    static const std::vector<VerifyCase> cases = [] {
        std::vector<VerifyCase> all;
        for (const Case& entry : entries()) all.push_back(entry.about);
        return all;
    }();
    return cases;
}

void check_verify_cases(std::span<const std::string> names) {
    for (const std::string& name : names) (void)entry_of(name);
}

VerifyResult run_verify_case(const Device& device, const std::string& name, const VerifyOptions& options) {
    const VerifyOptions with = with_threads(device, options);
    Devices more(device);
    return run_case(device, more, name, with);
}

void run_verify_cases(const Device& device, std::span<const std::string> names, const VerifyOptions& options,
                      const std::function<void(const VerifyResult&)>& report) {
    check_verify_cases(names);
    std::vector<std::size_t> which(names.size());
    std::iota(which.begin(), which.end(), std::size_t(0));
    InOrder in_order(names.size(), report);
    run_numbered_cases(device, names, which, options,
                       {[](std::size_t) { return true; },
                        [&](std::size_t i, const VerifyResult& result) { in_order.add(i, result); }});
}

}  // namespace claray
