// The one exception type of claray: what went wrong, where, and what to do about it.
#pragma once

#include <stdexcept>
#include <string>

namespace claray {

/// Who can mend an error. The values are the exit codes of the program `claray`.
enum class ErrorKind : int {
    user = 1,   ///< input or environment: a missing file, a bad mesh, a full disk
    usage = 2,  ///< the call or the command line itself
    device = 3  ///< OpenCL: no platform, a failed kernel build, out of device memory
};

/// `what()` is one line, "what failed: why; remedy", of at most 280 bytes of valid UTF-8 without control characters:
/// what is not fit for a terminal becomes '?', and what is too long loses its middle. Failures of a device add a line
/// break and a report of many lines.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message, const std::string& remedy = {}, const std::string& report = {});

    [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }

private:
    ErrorKind kind_;
};

}  // namespace claray
