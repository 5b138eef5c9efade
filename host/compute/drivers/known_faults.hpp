// Drivers that are known to give wrong results (docs/drivers/faults.md).
#pragma once

#include <string>

#include "claray/device.hpp"

namespace claray {

/// What is wrong with the device's driver in all renders, and what to install; empty for other drivers.
[[nodiscard]] std::string known_fault(const DeviceInfo& device);

}  // namespace claray
