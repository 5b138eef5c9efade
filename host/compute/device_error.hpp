// Turns errors of OpenCL into claray::Error, with everything that a failure report needs.
#pragma once

#include "claray/device.hpp"

namespace claray {

/// Lines that say on what something failed: device, driver, the digest of the kernels' sources, and `options` of the
/// compiler where they are known.
[[nodiscard]] std::string failure_report(const Device& device, const std::string& options = {});

/// "cannot DOING on the device: clFunction gave -5", and the report in further lines.
[[noreturn]] void throw_device_error(const Device& device, const std::string& doing, const cl::Error& error,
                                     const std::string& options = {});

}  // namespace claray
