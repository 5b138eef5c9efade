// Runs cases in a child process: a driver that hangs or crashes fails a case, and the other cases go on.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "claray/verify.hpp"

namespace claray::verify {

/// Seconds after which a case of the quick effort hangs, unless the user sets a limit.
inline constexpr double quick_limit = 600;

/// What is heard while cases run, by their numbers. One call at a time, from any thread.
struct CaseEvents {
    std::function<bool(std::size_t)> begun;  ///< returns false if the case must not run: another process has it
    std::function<void(std::size_t, const VerifyResult&)> ended;
};

/// Runs the cases `which` of `names` and tells when each begins and ends. Cases that may run at once do so in an order
/// that begins with those that compile longest. An exception of an event ends the run, and is thrown again.
void run_numbered_cases(const Device& device, std::span<const std::string> names, std::span<const std::size_t> which,
                        const VerifyOptions& options, const CaseEvents& events);

/// What a child process does.
struct ApartJob {
    std::function<DeviceInfo()> open;
    /// Runs the cases of these numbers, one after the other if `one_by_one`.
    std::function<void(std::span<const std::size_t> which, bool one_by_one, const CaseEvents& events)> run;
    double seconds_to_open = 120;  ///< after which a driver hangs
    /// How many processes share the cases; one if empty.
    std::function<unsigned(const DeviceInfo&)> processes = {};
};

/// What the child processes tell this one.
struct ApartEvents {
    std::function<void(const DeviceInfo&)> opened;  ///< once
    std::function<void(std::size_t, const VerifyResult&)> ended;
    /// The case did not end: why, and after how many seconds.
    std::function<void(std::size_t, const std::string& why, double seconds)> died;
};

/// Runs the cases `which` in child processes. If one dies, or if a case takes more than `limit` seconds (0: no limit),
/// that case has died, and a new process goes on with the others. If the process had several under way, they run again
/// one by one, as do all that follow. Throws what `open` and `run` throw, and ErrorKind::device if a process dies
/// before a device is open.
void run_in_children(const ApartJob& job, std::vector<std::size_t> which, double limit, const ApartEvents& events);

/// As run_verify_cases, in child processes: this process makes no call of OpenCL. `limit` is in seconds; 0: none. A
/// case that died fails. Calls `open` in each child, and `opened` once, before the first report. Throws as `open` does.
void run_verify_cases_apart(const std::function<Device()>& open, std::span<const std::string> names,
                            const VerifyOptions& options, double limit,
                            const std::function<void(const DeviceInfo&)>& opened,
                            const std::function<void(const VerifyResult&)>& report);

/// Whether the case compares times, so that nothing else may run beside it.
[[nodiscard]] bool measures_times(const std::string& name);

/// The command line that repeats a case.
[[nodiscard]] std::string command_of(const std::string& name, const VerifyOptions& options, const DeviceInfo& device);

/// The figure of a case that did not come to its end.
inline constexpr const char* unended_figure = "runs that do not come to their end";
[[nodiscard]] VerifyResult unended(const std::string& name, const VerifyOptions& options, const DeviceInfo& device,
                                   const std::string& why, double seconds);

/// Passes on results that arrive in any order, in the order of their numbers.
class InOrder {
public:
    explicit InOrder(std::size_t count, std::function<void(const VerifyResult&)> report)
        : results_(count), report_(std::move(report)) {}
    void add(std::size_t i, const VerifyResult& result);

private:
    std::vector<std::optional<VerifyResult>> results_;
    std::size_t next_ = 0;
    std::function<void(const VerifyResult&)> report_;
};

}  // namespace claray::verify
