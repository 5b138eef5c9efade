// The time to compile a kernel, and the driver's report on the result.
#pragma once

#include <optional>

#include "claray/program.hpp"

namespace claray {

struct BuildReport {
    double milliseconds = 0;                         ///< from source to machine code, without caches
    std::optional<unsigned> registers, spill_bytes;  ///< per work-item, of the kernel that needs most; if reported
};

/// Compiles one of claray's kernel files as `load_kernel` would, only to measure.
[[nodiscard]] BuildReport report_build(const Device& device, const std::string& file, const Defines& defines);

/// Registers and spills from a build log of NVIDIA's compiler under -cl-nv-verbose.
void read_build_log(const std::string& log, BuildReport& report);

}  // namespace claray
