// Starts other processes.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace claray {

/// Starts a program that prints nothing, and reads nothing if `input` is negative. Returns its process number, or 0 if
/// it cannot be started. It inherits `file`, unless that is negative, as the first file after the standard streams.
[[nodiscard]] pid_t start_silently(std::vector<std::string> arguments, int file = -1, int input = -1);

/// Waits for a process. Returns whether it ended with the exit code 0.
bool wait_for_process(pid_t id);

/// How a program ended, and what it wrote.
struct ProgramOutput {
    enum class End { exited, killed, too_slow, too_long, not_started };
    End end = End::not_started;
    int code = 0;  ///< the exit code, or the signal that killed it
    std::string output, errors;
};
struct ProgramLimits {
    double seconds = 0;     ///< of the clock; a program that takes longer is killed
    std::size_t bytes = 0;  ///< of its output; a program that writes more is killed, too
};
/// Runs a program that reads nothing. Of its standard error the first 64 KiB are kept.
[[nodiscard]] ProgramOutput run_program(std::vector<std::string> arguments, const ProgramLimits& limits);

/// A program that answers each line of its standard input by one line. It ends when its input does.
class AnsweringProcess {
public:
    explicit AnsweringProcess(std::vector<std::string> arguments);
    ~AnsweringProcess();
    AnsweringProcess(const AnsweringProcess&) = delete;
    AnsweringProcess& operator=(const AnsweringProcess&) = delete;

    /// Blocks. Empty if the process could not be started or has ended.
    [[nodiscard]] std::string ask(const std::string& line);
    [[nodiscard]] bool has_ended() const { return socket_ < 0; }

private:
    void end();

    int socket_ = -1;  // both standard streams of the process
    pid_t id_ = 0;
};

/// The path of this program; empty if the system does not provide it.
[[nodiscard]] std::string this_program();

}  // namespace claray
