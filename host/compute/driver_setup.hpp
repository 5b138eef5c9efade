// Prepares the process for drivers, before the first of them is loaded.
#pragma once

#include <string>

namespace claray {

/// Once in a process, before the first call of OpenCL. PoCL finds no device, or crashes, where it can't write to its
/// cache: where the user names no folder for it and its own default can't be written to, it gets claray's. Worker
/// threads get a stack of 8 MiB, whatever `ulimit -s` says: kernels run on it. Throws ErrorKind::user where
/// $POCL_CACHE_DIR can't be written to.
void set_up_drivers();

/// The remedy to name when there is no device.
[[nodiscard]] std::string no_device_remedy();

}  // namespace claray
