// Tells what is compiled and how far: the first start on a device compiles kernels for seconds, or on GPUs a minute.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Kernels that this process and its compilers have compiled since it began, and the sum of these and those that are
/// known to be missing. Kernels that come from the cache are not counted.
struct CompileProgress {
    unsigned done = 0, total = 0;
    bool operator==(const CompileProgress&) const = default;
};
using TellCompiling = std::function<void(const CompileProgress&)>;

/// Calls `tell` when a compilation begins and when a kernel is done, from any thread, one call at a time. Without a
/// function, which is the default, nothing is reported. `tell` must not use a device.
void on_compiling(TellCompiling tell);

/// "compiling 7 of 15 kernels, once for this device". Counts the kernel that is compiled now.
[[nodiscard]] std::string text_of(const CompileProgress& progress);

/// Prints this text: on a terminal on one line, which is erased in the end; elsewhere a line now and then, the first at
/// once.
[[nodiscard]] TellCompiling compiling_lines(std::FILE* to = stderr);

}  // namespace claray
#pragma GCC visibility pop
