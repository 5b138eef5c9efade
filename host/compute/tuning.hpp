// The tuning table: values per device, kernel and parameter, kept out of the code (habit of hashcat's tunings/).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "claray/program.hpp"

namespace claray {

/// Returns whether a row's pattern matches this device: '*' matches any; "cpu" and "gpu" its type; otherwise a part of
/// its name, in which '_' matches any character.
bool pattern_matches(const std::string& pattern, const DeviceInfo& info);

/// The user's own table, $XDG_CONFIG_HOME/claray/tuning.txt or ~/.config/claray/tuning.txt; empty if neither variable
/// is set. It need not exist. `claray tune` writes it.
std::filesystem::path local_tuning_path();

/// The values to which a user's table may set a parameter.
struct TuningRange {
    unsigned least = 0, most = 0xffffffffu;
    bool powers = false;  ///< powers of two only
    [[nodiscard]] bool holds(unsigned value) const;
    [[nodiscard]] std::string text() const;
};

/// The values and ranges of one device, by "kernel parameter". A user cannot set a parameter without a range.
struct Tuning {
    std::map<std::string, unsigned> values;
    std::map<std::string, TuningRange> ranges;
    std::vector<std::string> warnings;  ///< of ignored rows: file, line and remedy, one line each
};

/// Resolves kernels/tuning.txt, then the user's table if it exists, then the file named by $CLARAY_TUNING, for one
/// device. Rows whose pattern does not match are ignored; later rows override earlier ones. Throws ErrorKind::user
/// naming the line of a malformed row.
Tuning tuning_for(const DeviceInfo& info);

/// Applies claray's own table, which defines the parameters; `name` appears in errors.
void apply_tuning(const std::string& text, const std::string& name, const DeviceInfo& info, Tuning& tuning);
/// Applies a user's table. Values become macros of kernels; therefore only parameters and values that claray's own
/// table allows are accepted. Other rows are ignored, with one warning each.
void apply_users_tuning(const std::string& text, const std::string& name, const DeviceInfo& info, Tuning& tuning);

/// The macros of a kernel, extended by the table's rows for `stem` ("trace/any_hit") that it does not define.
[[nodiscard]] Defines with_tuning(const Device& device, const std::string& stem, Defines defines);

}  // namespace claray
