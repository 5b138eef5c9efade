// The tuning table: values per device, kernel and parameter, kept out of the code (habit of hashcat's tunings/).
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "claray/program.hpp"

namespace claray {

/// Whether a row of this pattern is for this device: '*' any; "cpu", "gpu": its type; otherwise a part of its name, in
/// which '_' stands for any one character.
bool pattern_matches(const std::string& pattern, const DeviceInfo& info);

/// The user's own table, $XDG_CONFIG_HOME/claray/tuning.txt or ~/.config/claray/tuning.txt; empty where neither
/// variable is set. It need not exist. `claray tune` writes it.
std::filesystem::path local_tuning_path();

/// Resolves kernels/tuning.txt, then the user's table where there is one, then the file named by $CLARAY_TUNING, for
/// one device: "kernel parameter" -> value. Later rows win over earlier ones, and only rows whose pattern matches
/// count. Throws ErrorKind::user naming the line of a malformed row.
std::map<std::string, unsigned> tuning_for(const DeviceInfo& info);

/// The same for one table's text; `name` appears in errors.
void apply_tuning(const std::string& text, const std::string& name, const DeviceInfo& info,
                  std::map<std::string, unsigned>& values);

/// Macros of a kernel, and of the table's rows for `stem` ("trace/any_hit") those that are not among them.
[[nodiscard]] Defines with_tuning(const Device& device, const std::string& stem, Defines defines);

}  // namespace claray
