// What shows a fault of a driver without claray: claray verify --reduce.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "claray/verify.hpp"

namespace claray::verify {

/// Runs cases and passes on each result.
using RunCases =
    std::function<void(const std::vector<std::string>& names, const std::function<void(const VerifyResult&)>& report)>;

/// The probes that a reduction writes: those among `names`, whether they fail or not; and those that fail if `names` is
/// empty, or has a failing case that is no probe. Tells `say` what it finds, in lines.
[[nodiscard]] std::vector<std::string> probes_to_write(const std::vector<std::string>& names, const RunCases& run,
                                                       const std::function<void(const std::string&)>& say);

/// Writes a probe as NAME.cl and NAME.c to a folder, which is made if need be, and returns how to compile and run them.
/// A complete file of this name is replaced by a complete one. Throws ErrorKind::user naming the path.
[[nodiscard]] std::string write_probe(const std::filesystem::path& folder, const std::string& name);

}  // namespace claray::verify
