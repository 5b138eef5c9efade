// Starts other processes.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace claray {

/// Starts a program that reads and prints nothing. Returns its process number, or 0 if it cannot be started. It
/// inherits `file`, unless that is negative, as the first file after the standard streams.
[[nodiscard]] pid_t start_silently(std::vector<std::string> arguments, int file = -1);

/// Waits for a process. Returns whether it ended with the exit code 0.
bool wait_for_process(pid_t id);

/// The path of this program; empty if the system does not provide it.
[[nodiscard]] std::string this_program();

}  // namespace claray
