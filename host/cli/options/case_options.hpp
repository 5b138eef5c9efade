// The options of commands that run cases of `verify`, and their run in child processes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "claray/verify.hpp"

namespace claray::cli {

struct CaseOptions {
    VerifyOptions how;
    std::vector<std::string> cases;  // none: all
    std::string device;
    std::optional<double> limit;  // in seconds
    bool full = false, quick = false;

    /// With the effort that the flags ask for.
    [[nodiscard]] VerifyOptions verify_options() const;
};

void add_case_options(CLI::App& command, CaseOptions& options);
/// Throws ErrorKind::usage about flags that exclude each other.
void refuse_contradicting_case_options(const CLI::App& command);

struct Verified {
    DeviceInfo device;
    std::vector<VerifyResult> results;
    double seconds = 0;
};

/// Runs the cases and passes on each result. `opened` is called once, before. Throws ErrorKind::usage for unknown cases
/// and devices.
[[nodiscard]] Verified run_cases(const CaseOptions& options, const std::function<void(const DeviceInfo&)>& opened,
                                 const std::function<void(const VerifyResult&)>& report);

/// Throws ErrorKind::device, which names the cases that fail, if there are any.
void refuse_failed(const Verified& verified);

}  // namespace claray::cli
