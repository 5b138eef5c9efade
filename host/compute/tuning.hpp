// The tuning table: values per device, kernel and parameter, kept out of the code (habit of hashcat's tunings/).
#pragma once

#include <map>
#include <string>

#include "claray/device.hpp"

namespace claray {

/// Resolves kernels/tuning.txt, then the file named by $CLARAY_TUNING, for one device: "kernel parameter" -> value.
/// Later rows win over earlier ones, and only rows whose pattern matches count. Throws ErrorKind::user naming the line
/// of a malformed row.
std::map<std::string, unsigned> tuning_for(const DeviceInfo& info);

/// The same for one table's text; `name` appears in errors.
void apply_tuning(const std::string& text, const std::string& name, const DeviceInfo& info,
                  std::map<std::string, unsigned>& values);

}  // namespace claray
