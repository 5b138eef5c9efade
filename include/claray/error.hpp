// The only exception type of claray. The message tells what failed, where, and what to do. All headers include this one
// first, so that compilers of an older standard give one clear error.
#pragma once

#if __cplusplus <= 201703L
#error "claray needs C++20: compile with -std=c++20, or set CMAKE_CXX_STANDARD to 20"
#endif

#include <stdexcept>
#include <string>

#pragma GCC visibility push(default)
namespace claray {

/// The cause of an error. The values are the exit codes of the program `claray`.
enum class ErrorKind : int {
    user = 1,   ///< input or environment: a missing file, a bad mesh, a full disk
    usage = 2,  ///< an invalid call or command line
    device = 3  ///< OpenCL: no platform, a failed kernel build, out of device memory
};

/// `what()` is one line, "what failed: why; remedy", of at most 280 bytes of valid UTF-8 without control characters.
/// Characters that a terminal cannot show become '?'; messages that are too long are shortened in the middle. Device
/// errors append a line break and a report of several lines.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message, const std::string& remedy = {}, const std::string& report = {});

    [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }

private:
    ErrorKind kind_;
};

}  // namespace claray
#pragma GCC visibility pop
