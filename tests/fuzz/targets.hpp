// What is fuzzed: everything that reads a file of others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace claray::test {

struct FuzzTarget {
    const char* name;
    /// Reads the bytes as such a file. Nothing but claray::Error of kind `user` may come of it: whatever else is thrown
    /// ends the process, as a sanitizer's report does. Returns whether the file was read, and not refused.
    bool (*run)(std::span<const std::uint8_t> bytes);
};

[[nodiscard]] std::span<const FuzzTarget> fuzz_targets();

/// The same for a scene file whose name tells its format. Returns whether it was read.
[[nodiscard]] bool read_scene(const char* name, std::span<const std::uint8_t> bytes);

}  // namespace claray::test
