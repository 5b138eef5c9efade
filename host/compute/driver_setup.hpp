// Prepares the process for drivers, before the first of them is loaded.
#pragma once

#include <functional>
#include <string>

namespace claray {

/// Must be called once per process, before the first call of OpenCL. PoCL gets a folder (pocl_folder.hpp), and drivers
/// that crash are left out (icd.hpp). Worker threads get a stack of 8 MiB, whatever `ulimit -s` says, because kernels
/// run on it. PoCL compiles each kernel once, for work-groups of any size, unless $POCL_WORK_GROUP_SPECIALIZATION is
/// set. Throws ErrorKind::user if $POCL_CACHE_DIR is not writable.
void set_up_drivers();

/// Runs `start`, the first call that makes PoCL start its threads, and binds each of them to a processor, unless the
/// user sets $POCL_AFFINITY. When a kernel starts, all of them wake up at once, while the thread that launches it still
/// occupies a processor. Linux then places two on one processor, where the second waits for milliseconds. Later calls
/// only run `start`.
void bind_threads_started_by(const std::function<void()>& start);

/// The remedy to state if there is no device.
[[nodiscard]] std::string no_device_remedy();

}  // namespace claray
