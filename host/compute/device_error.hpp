// Converts OpenCL errors to claray::Error, with all data that a failure report needs.
#pragma once

#include "claray/device.hpp"

namespace claray {

/// Lines that describe the device, the driver, the digest of the kernel sources and, if known, the compiler's
/// `options`.
[[nodiscard]] std::string failure_report(const Device& device, const std::string& options = {});

/// "cannot DOING on the device: clFunction gave -5", and the report in further lines.
[[noreturn]] void throw_device_error(const Device& device, const std::string& doing, const cl::Error& error,
                                     const std::string& options = {});

}  // namespace claray
