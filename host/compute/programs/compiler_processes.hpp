// Compiles programs in other processes: NVIDIA's driver compiles one program of a process at a time, whatever the
// number of threads and contexts, but those of several processes at once.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/compute/programs/kernel_set.hpp"

namespace claray {

/// The program that compiles for this process: `claray`, which names itself. Empty (by default): there is none, and
/// nothing is compiled in other processes. To be called before other threads begin.
void set_compiler_program(const std::string& path);

/// Whether programs for this device are compiled in other processes (compute/programs PROCESSES in
/// kernels/tuning.txt).
[[nodiscard]] bool has_compiler_processes(const Device& device);

/// Compiles programs in other processes, so that the cache holds them afterwards. Programs that another thread compiles
/// so at the same time are waited for. Blocks. A program that fails is not in the cache, and whoever compiles it next
/// learns why. `one_done` is called after each, from any thread.
void compile_in_processes(const Device& device, const std::vector<ProgramRequest>& programs,
                          const std::function<void()>& one_done = {});

/// While one exists, the processes wait for more programs: opening a context takes each 0.3 s, one after the other.
class KeepCompilers {
public:
    KeepCompilers();
    ~KeepCompilers();
    KeepCompilers(const KeepCompilers&) = delete;
    KeepCompilers& operator=(const KeepCompilers&) = delete;
};

/// Such a process: compiles the programs that it reads from standard input for the cache, until its end.
void serve_as_compiler(const Device& device);

}  // namespace claray
