// The tuning table: values per device, kernel and parameter, kept out of the code (habit of hashcat's tunings/).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "claray/program.hpp"

namespace claray {

/// Whether a row of this pattern is for this device: '*' any; "cpu", "gpu": its type; otherwise a part of its name, in
/// which '_' stands for any one character.
bool pattern_matches(const std::string& pattern, const DeviceInfo& info);

/// The user's own table, $XDG_CONFIG_HOME/claray/tuning.txt or ~/.config/claray/tuning.txt; empty where neither
/// variable is set. It need not exist. `claray tune` writes it.
std::filesystem::path local_tuning_path();

/// What a user's table may set a parameter to.
struct TuningRange {
    unsigned least = 0, most = 0xffffffffu;
    bool powers = false;  ///< of two only
    [[nodiscard]] bool holds(unsigned value) const;
    [[nodiscard]] std::string text() const;
};

/// The values and ranges of one device, by "kernel parameter". Without a range nothing may be set by a user.
struct Tuning {
    std::map<std::string, unsigned> values;
    std::map<std::string, TuningRange> ranges;
    std::vector<std::string> warnings;  ///< of rows that are ignored: file, line and remedy, a line each
};

/// Resolves kernels/tuning.txt, then the user's table where there is one, then the file named by $CLARAY_TUNING, for
/// one device. Later rows win over earlier ones, and only rows whose pattern matches count. Throws ErrorKind::user
/// naming the line of a malformed row.
Tuning tuning_for(const DeviceInfo& info);

/// Applies claray's own table, which says what can be tuned; `name` appears in errors.
void apply_tuning(const std::string& text, const std::string& name, const DeviceInfo& info, Tuning& tuning);
/// Applies a user's table: a value becomes a macro of a kernel, so that only parameters and values that claray's own
/// table allows are taken. The other rows are ignored, with a warning each.
void apply_users_tuning(const std::string& text, const std::string& name, const DeviceInfo& info, Tuning& tuning);

/// Macros of a kernel, and of the table's rows for `stem` ("trace/any_hit") those that are not among them.
[[nodiscard]] Defines with_tuning(const Device& device, const std::string& stem, Defines defines);

}  // namespace claray
