// Device memory in use, and the memory that an object would need before it is made.
#pragma once

#include <cstdint>
#include <string>

#include "claray/device.hpp"

namespace claray {

/// From its construction to its end buffers on the device are not made: their bytes are added up. What is constructed
/// meanwhile must only allocate, not compute; it can't be used afterwards. Plans may not be nested.
class MemoryPlan {
public:
    explicit MemoryPlan(const Device& device);
    ~MemoryPlan();
    MemoryPlan(const MemoryPlan&) = delete;
    MemoryPlan& operator=(const MemoryPlan&) = delete;

    void add(std::uint64_t bytes);
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
    [[nodiscard]] std::uint64_t largest() const { return largest_; }

private:
    Device device_;
    std::uint64_t bytes_ = 0, largest_ = 0;
};

/// Bytes of all buffers that claray holds on the device.
[[nodiscard]] std::uint64_t bytes_in_use(const Device& device);
/// Bytes that claray can still take: what the device has less what is in use. What other programs hold is not known.
[[nodiscard]] std::uint64_t bytes_available(const Device& device);

/// Whether the device gives a buffer of this size, though it may be larger than the largest it promises: NVIDIA's and
/// AMD's drivers, for instance, promise a quarter of the memory and often give more.
[[nodiscard]] bool gives_buffer(const Device& device, std::uint64_t bytes);

/// For tests: the nth allocation, or the nth run of a kernel, from now on fails as if the driver refused; 0: none does.
void fail_allocation(const Device& device, unsigned nth);
void fail_command(const Device& device, unsigned nth);
/// Counts down to 1, where it throws this error of OpenCL; at 0 it does nothing.
void fail_if_asked(unsigned& countdown, int error);

/// "12.3 MB", "4.56 GB"
[[nodiscard]] std::string size_text(std::uint64_t bytes);

}  // namespace claray
