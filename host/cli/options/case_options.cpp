#include "host/cli/options/case_options.hpp"

#include "host/base/seconds_since.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/verify/apart/run_apart.hpp"

namespace claray::cli {

VerifyOptions CaseOptions::verify_options() const {
    VerifyOptions options = how;
    options.effort = full ? Effort::full : Effort::quick;
    return options;
}

void add_case_options(CLI::App& command, CaseOptions& o) {
    command.add_flag("--quick", o.quick, "Run few trials: minutes, most of them to compile kernels (default)");
    command.add_flag("--full", o.full, "Run the full number of trials: minutes on a GPU, hours on a few CPU cores");
    command.add_option("--case", o.cases, "Run only this case; may be repeated")->allow_extra_args(false);
    command
        .add_option("--limit", o.limit,
                    "Time after which a case is ended and fails: 90, 90s, 5m [10m; with --full none]")
        ->transform(duration());
    command.add_option("--seed", o.how.seed, "Seed of random rays and meshes [1]")
        ->transform(whole_number(0, UINT64_MAX));
    command.add_flag("!--no-times", o.how.times, "Do not check ratios of times (for busy machines)");
    command
        .add_option("--threads", o.how.threads,
                    "Cases run at once [CPUs: 2; NVIDIA: number of processors, at most 5; else 1]")
        ->transform(whole_number(1, 64));
    command.add_option("--device", o.device, "cpu, gpu, an index or part of a name (see claray devices)");
}

void refuse_contradicting_case_options(const CLI::App& command) {
    refuse_both(command, "--quick", {"--full"}, "choose one");
}

Verified run_cases(const CaseOptions& options, const std::function<void(const DeviceInfo&)>& opened,
                   const std::function<void(const VerifyResult&)>& report) {
    std::vector<std::string> names = options.cases;
    if (names.empty())
        for (const VerifyCase& c : verify_cases()) names.push_back(c.name);
    Verified verified;
    const auto begin = std::chrono::steady_clock::now();
    bool warned = false;  // by the first child process
    const auto open = [&] { return warned ? Device::open(options.device) : open_device(options.device); };
    const auto tell = [&](const DeviceInfo& device) {
        warned = true;
        opened(verified.device = device);
    };
    const auto keep = [&](const VerifyResult& result) {
        report(result);
        verified.results.push_back(result);
    };
    verify::run_verify_cases_apart(open, names, options.verify_options(),
                                   options.limit.value_or(options.full ? 0 : verify::quick_limit), tell, keep);
    verified.seconds = seconds_since(begin);
    return verified;
}

void refuse_failed(const Verified& verified) {
    std::string which;
    std::size_t failed = 0;
    for (const VerifyResult& result : verified.results)
        if (!result.holds()) which += (failed++ == 0 ? "" : ", ") + result.name;
    if (failed > 0)
        throw Error(ErrorKind::device,
                    std::to_string(failed) + " of " + std::to_string(verified.results.size()) + " cases fail on " +
                        verified.device.name + ": " + which,
                    "do not rely on this driver in these cases; the commands above repeat them");
}

}  // namespace claray::cli
