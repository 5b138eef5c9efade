// Compiles programs by the driver, or loads them from the cache on disk.
#pragma once

#include <chrono>

#include "claray/program.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {

/// Those given to a kernel file and its rows of the tuning table, without the macros that its text does not need: what
/// the host alone reads must not compile a kernel again. CLARAY_... are switches of whole programs, such as fast math.
[[nodiscard]] Defines macros_of(const Device& device, const std::string& file, const Defines& defines);
/// The options of the compiler.
[[nodiscard]] std::string build_options(const Device& device, const Defines& defines, Math math = Math::strict);

/// Loads a program from the cache, or compiles and stores it. `kernels`: how many are told to be compiled if the cache
/// does not have the program; 0 if they were told before. Throws ErrorKind::device with the compiler's log.
[[nodiscard]] cl::Program compile_program(const Device& device, const KernelSource& main, const std::string& options,
                                          unsigned kernels = 1);
/// Compiles a program that the cache never has: PoCL compiles a program again to store it.
[[nodiscard]] cl::Program compile_for_now(const Device& device, const KernelSource& main, const std::string& options,
                                          unsigned kernels);
/// Everything on which a binary depends, its key in the cache.
[[nodiscard]] std::string cache_identity(const Device& device, const KernelSource& main, const std::string& options);
/// The key in Device::State::programs.
[[nodiscard]] std::string key_in_memory(const KernelSource& main, const std::string& options, bool user_source = false);

/// Adds its lifetime to CompileStatistics::milliseconds.
class TimeOfCompiling {
public:
    TimeOfCompiling() = default;
    ~TimeOfCompiling();
    TimeOfCompiling(const TimeOfCompiling&) = delete;
    TimeOfCompiling& operator=(const TimeOfCompiling&) = delete;

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace claray
