// `claray tune`: tries the values of kernels/tuning_candidates.txt and finds the faster ones.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "claray/device.hpp"

namespace claray::measure {

/// A parameter of the tuning table and the values to try.
struct TuningCandidates {
    std::string kernel, parameter;
    std::vector<std::string> work;  ///< "fast", "balanced", "rays", "closest", "any", "render"
    std::vector<unsigned> values;
};
/// The rows that match a device, one per parameter. Throws ErrorKind::user with the line of a malformed row.
[[nodiscard]] std::vector<TuningCandidates> parse_candidates(const std::string& text, const std::string& name,
                                                             const DeviceInfo& info);
/// Those of kernels/tuning_candidates.txt.
[[nodiscard]] std::vector<TuningCandidates> candidates_for(const DeviceInfo& info);

/// One value that was tried.
struct Trial {
    std::string kernel, parameter;
    unsigned value = 0;
    bool in_force = false;    ///< the value before tuning
    double milliseconds = 0;  ///< of all that was measured, together
    double ratio = 1;  ///< time over that of the value in force: median over the rounds, each compared with itself
    double noise = 0;  ///< standard error of that ratio
    bool kept = false;
    std::string failure;  ///< why the value can't be used, where it can't
};

/// A row for the tuning table.
struct TunedRow {
    std::string kernel, parameter;
    unsigned value = 0;
    double ratio = 1;
    bool measured = false;  ///< a figure of the device's model, nothing that was tried
};

struct TuneOptions {
    std::vector<std::string> scenes;
    unsigned width = 192, height = 108;  ///< of each of three views
    int repeat = 9;                      ///< rounds that count
    std::string only;                    ///< tunes only parameters whose "kernel PARAMETER" holds this text
};

/// Tries every value of every parameter in interleaved rounds. A value is kept if it saves at least 2 % of the time and
/// twice the noise in two measurements: against all other values, and against the value in force alone. Values that
/// change results are refused. Sets the best values on `device`. Calls `on_trials` for each parameter.
[[nodiscard]] std::vector<TunedRow> tune(const Device& device, const TuneOptions& options,
                                         const std::vector<TuningCandidates>& candidates,
                                         const std::function<void(const std::vector<Trial>&)>& on_trials);

/// Median and standard error of the ratio of paired times. The error is that of a median of normally distributed
/// values: 1.2533 sigma / sqrt(n), with sigma from the median absolute deviation.
struct PairedRatio {
    double ratio = 1, noise = 0;
    /// Saves at least 2 %, and twice the noise.
    [[nodiscard]] bool faster() const { return ratio < 0.98 && ratio + 2 * noise < 1; }
};
[[nodiscard]] PairedRatio paired_ratio(const std::vector<double>& times, const std::vector<double>& base);

/// A tuning table's text in which these rows replace those of the same device pattern, kernel and parameter.
[[nodiscard]] std::string with_rows(const std::string& table, const DeviceInfo& info,
                                    const std::vector<TunedRow>& rows);

}  // namespace claray::measure
