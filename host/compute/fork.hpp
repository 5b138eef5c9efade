// Processes that fork() made after OpenCL was used: the threads of the drivers do not exist there, so that calls never
// return.
#pragma once

namespace claray {

/// Called before the first call of OpenCL, and then any number of times: forks are noted from now on.
void note_forks();

/// Whether this process was made by fork() after OpenCL was used.
[[nodiscard]] bool is_forked() noexcept;

/// Throws ErrorKind::usage in such a process. Called before commands, allocations and waiting.
void refuse_if_forked();

}  // namespace claray
