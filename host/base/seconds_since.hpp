// Measures time that passes, and time of the processor.
#pragma once

#include <chrono>
#include <ctime>

namespace claray {

[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Of all threads of this process so far.
[[nodiscard]] inline double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace claray
