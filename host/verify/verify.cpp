#include "claray/verify.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <future>
#include <map>
#include <set>
#include <thread>

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
             {probe_cases,  device_cases, function_cases,  edge_cases,     triangle_cases,  box_cases,
              tree_cases,   refit_cases,  instance_cases,  query_cases,    primitive_cases, material_cases,
              media_cases,  image_cases,  harmonics_cases, shading_cases,  gbuffer_cases,   wave_cases,
              random_cases, light_cases,  sameness_cases,  committed_cases})
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
    result.command = "claray verify --case " + name + (options.effort == Effort::full ? " --full" : " --quick") +
                     " --seed " + std::to_string(options.seed) + " --device '" + std::to_string(device.info().index) +
                     "'";
    const auto begin = std::chrono::steady_clock::now();
    verify::Run run(device, more, options, result);
    {
        const KernelsRun kernels(device, options.kernels, result.kernels);
        entry.run(run);
    }
    device.finish();
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
}

/// A smaller number for cases that compile longer: nan-pixels renders with all effects at once.
int rank_of(const std::string& name) {
    const std::string family = entry_of(name).about.family;
    return name == "nan-pixels" ? 0 : family == "images" || family == "materials" ? 1 : 2;
}

/// Cases that run side by side, in an order that begins with those that compile longest.
class Crew {
public:
    Crew(const Device& device, Devices& more, std::vector<std::string> names, const VerifyOptions& options)
        : more_(more), names_(std::move(names)) {
        std::stable_sort(names_.begin(), names_.end(),
                         [](const std::string& a, const std::string& b) { return rank_of(a) < rank_of(b); });
        for (const std::string& name : names_) found_[name] = results_.emplace_back().get_future();
        work_ = std::thread([this, device, options] {
            side_by_side(device, more_, options.threads, names_.size(), [&](const Device& on, std::size_t i) {
                if (!ends_) run(on, i, options);
            });
        });
    }
    ~Crew() {
        ends_ = true;  // cases that have not begun are cancelled
        wait();
    }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;

    [[nodiscard]] bool has(const std::string& name) const { return found_.contains(name); }
    /// Waits for the case.
    [[nodiscard]] const VerifyResult& result_of(const std::string& name) const { return found_.at(name).get(); }
    /// Waits until no case is running.
    void wait() {
        if (work_.joinable()) work_.join();
    }

private:
    void run(const Device& device, std::size_t i, const VerifyOptions& options) {
        try {
            results_[i].set_value(run_case(device, more_, names_[i], options));
        } catch (...) {
            results_[i].set_exception(std::current_exception());
        }
    }

    Devices& more_;
    std::vector<std::string> names_;
    std::deque<std::promise<VerifyResult>> results_;
    std::map<std::string, std::shared_future<VerifyResult>> found_;
    std::atomic<bool> ends_{false};
    std::thread work_;
};

/// A CPU driver already has a thread per processor. GPUs wait for compilers.
unsigned threads_for(const Device& device, const VerifyOptions& options) {
    if (options.threads != 0) return options.threads;
    if (device.info().type != DeviceType::gpu) return 1;
    return contexts_at_once();
}

VerifyOptions with_threads(const Device& device, VerifyOptions options) {
    options.threads = threads_for(device, options);
    return options;
}

}  // namespace

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
    Devices more(device);
    return run_case(device, more, name, with_threads(device, options));
}

void run_verify_cases(const Device& device, std::span<const std::string> names, const VerifyOptions& with,
                      const std::function<void(const VerifyResult&)>& report) {
    const VerifyOptions options = with_threads(device, with);
    std::set<std::string> side_by_side;
    for (const std::string& name : names)
        if (!(entry_of(name).measures_times && options.times) && options.threads > 1) side_by_side.insert(name);
    Devices more(device);
    Crew crew(device, more, {side_by_side.begin(), side_by_side.end()}, options);
    for (const std::string& name : names) {
        if (crew.has(name)) {
            report(crew.result_of(name));
            continue;
        }
        crew.wait();
        report(run_case(device, more, name, options));
    }
}

}  // namespace claray
