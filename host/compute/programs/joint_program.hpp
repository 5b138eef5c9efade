// Compiles programs before their kernels are loaded: several files as one program, or in parallel. A driver needs a
// tenth of a second even for a small program (PoCL 3.1: 75 ms for an empty kernel), or seconds (NVIDIA's); a first
// picture needs seven programs.
#pragma once

#include <functional>

#include "claray/program.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {

/// A file requested from load_kernel, with the macros of the tuning table.
struct KernelRequest {
    std::string file;
    Defines defines;
    bool operator==(const KernelRequest&) const = default;
};

struct JointSource {
    KernelSource source;
    std::vector<KernelRequest> members;
};

/// Joins as many requests as can share a program: if two give a macro different values, no header that they share may
/// mention it. The others, and second requests for a file, are left out.
[[nodiscard]] JointSource join(const std::vector<KernelRequest>& requests);

/// Compiles as one program the files that `load` requests from load_kernel, as far as they can be joined; `load_kernel`
/// then finds them compiled. `load` is called and gets kernels that cannot run. If the joint program does not compile,
/// nothing happens. Without `optimized` a program compiles in little more than half the time and runs several times
/// slower.
void compile_jointly(const Device& device, const std::function<void()>& load, bool optimized = true);

/// Compiles the files that `load` requests from load_kernel, or loads them from the cache: in parallel threads or
/// processes if the tuning table says that this suits the device, else one after the other, if someone is told how far
/// that is. `load` is called as above, and may call this, too. load_kernel reports files that do not compile.
void compile_side_by_side(const Device& device, const std::function<void()>& load);

/// Makes load_kernel forget programs that were not optimized. Loaded kernels are unaffected.
void forget_slow_programs(const Device& device);

}  // namespace claray
