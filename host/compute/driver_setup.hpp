// Prepares the process for drivers, before the first of them is loaded.
#pragma once

#include <string>

namespace claray {

/// Must be called once per process, before the first call of OpenCL. PoCL finds no device, or crashes, if it cannot
/// write to its cache: if the user sets no folder and PoCL's default is not writable, it gets claray's folder. Worker
/// threads get a stack of 8 MiB, whatever `ulimit -s` says, because kernels run on it. Throws ErrorKind::user if
/// $POCL_CACHE_DIR is not writable.
void set_up_drivers();

/// The remedy to state if there is no device.
[[nodiscard]] std::string no_device_remedy();

}  // namespace claray
