// What compiling a kernel costs, and what the driver tells about the outcome.
#pragma once

#include <optional>

#include "claray/program.hpp"

namespace claray {

struct BuildReport {
    double milliseconds = 0;                         ///< from source to machine code, past all caches
    std::optional<unsigned> registers, spill_bytes;  ///< per work-item, of the kernel that needs most; where it tells
};

/// Compiles one of claray's kernel files, as `load_kernel` would, for its cost alone.
[[nodiscard]] BuildReport report_build(const Device& device, const std::string& file, const Defines& defines);

/// Registers and spills from a build log of NVIDIA's compiler under -cl-nv-verbose.
void read_build_log(const std::string& log, BuildReport& report);

}  // namespace claray
