// Programs compiled before their kernels are loaded: several files as one program, or side by side. A driver takes a
// tenth of a second for a program, however small it is (PoCL 3.1: 75 ms of 80 for an empty kernel), or seconds
// (NVIDIA's); a first picture needs seven.
#pragma once

#include <functional>

#include "claray/program.hpp"
#include "host/compute/kernel_sources.hpp"

namespace claray {

/// A file as load_kernel was asked for it, with the macros of the tuning table.
struct KernelRequest {
    std::string file;
    Defines defines;
    bool operator==(const KernelRequest&) const = default;
};

struct JointSource {
    KernelSource source;
    std::vector<KernelRequest> members;
};

/// As many of the requests as can share a program: where two give a macro different values, none of the headers that
/// they share may mention it. The others, and a second request for a file, are left out.
[[nodiscard]] JointSource join(const std::vector<KernelRequest>& requests);

/// Compiles what `load` will ask load_kernel for, so far as it can be joined; `load_kernel` then finds it compiled.
/// `load` is called and gets kernels that can't run. Where the joint program doesn't compile, nothing happens. What is
/// not `optimized` takes little more than half as long to compile, and several times as long to run.
void compile_jointly(const Device& device, const std::function<void()>& load, bool optimized = true);

/// Compiles what `load` will ask load_kernel for, or loads it from the cache, by threads: where the tuning table says
/// that this suits the device. `load` is called as above. What doesn't compile is left to load_kernel, which says why.
void compile_side_by_side(const Device& device, const std::function<void()>& load);

/// load_kernel finds no program any more that was not optimized. Kernels that were loaded stay as they are.
void forget_slow_programs(const Device& device);

}  // namespace claray
