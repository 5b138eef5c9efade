// Several kernel files as one program, which a driver compiles in less time.
#pragma once

#include "host/compute/programs/kernel_set.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {

struct JointSource {
    KernelSource source;
    std::vector<ProgramRequest> members;
};

/// Joins as many programs as can share one: if two give a macro different values, no header that they share may mention
/// it. The others, and second requests for a file, are left out.
[[nodiscard]] JointSource join(const std::vector<ProgramRequest>& requests);

}  // namespace claray
