// The memory of this machine that is free.
#pragma once

#include <cstdint>

namespace claray {

/// Bytes that this process may still take without swapping: by the kernel's estimate, the limits of its control group
/// (version 2) and of its address space. The largest number where none of them is known.
[[nodiscard]] std::uint64_t free_host_memory();

}  // namespace claray
