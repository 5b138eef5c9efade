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

}  // namespace claray::test
