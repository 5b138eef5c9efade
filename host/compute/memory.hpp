// Device memory in use, and the memory that an object would need before it is created.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "claray/buffer.hpp"

namespace claray {

/// Thrown where memory ends.
class OutOfMemory : public Error {
public:
    OutOfMemory(const std::string& message, const std::string& remedy) : Error(ErrorKind::device, message, remedy) {}
};

/// During its lifetime buffers of the device are not created; their sizes are added up instead. Objects constructed
/// meanwhile must only allocate, not compute, and cannot be used afterwards. Plans must not be nested.
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

/// In its lifetime the driver must find the memory of each buffer at once. NVIDIA's otherwise does when a command first
/// uses the buffer, so that a scene would be refused only after much of it is uploaded. For buffers that no other queue
/// writes.
class MemoryCommit {
public:
    explicit MemoryCommit(const Device& device);
    ~MemoryCommit();
    MemoryCommit(const MemoryCommit&) = delete;
    MemoryCommit& operator=(const MemoryCommit&) = delete;

private:
    Device device_;
};

/// In its lifetime each new buffer of the device is filled with bytes of ones, which are NaN as floats: kernels that
/// read what nothing has written give themselves away. More such bytes follow its end, where no kernel may write.
class GuardedMemory {
public:
    explicit GuardedMemory(const Device& device);
    ~GuardedMemory();
    GuardedMemory(const GuardedMemory&) = delete;
    GuardedMemory& operator=(const GuardedMemory&) = delete;

    /// The buffers that were written beyond their end, of those that are gone.
    [[nodiscard]] std::uint64_t overruns() const { return *overruns_; }

private:
    Device device_;
    std::shared_ptr<std::atomic<std::uint64_t>> overruns_, before_;
};

/// Host memory to which the device copies fast. GPUs copy to page-locked memory several times as fast as to other
/// memory.
class HostMemory {
public:
    HostMemory(const Device& device, std::size_t bytes);
    [[nodiscard]] std::uint8_t* data() const { return data_.get(); }

    /// Copies the first elements of a buffer, at most as many as fit, and returns them; valid until the next call.
    /// Blocks.
    template <class T>
    [[nodiscard]] std::span<const std::uint8_t> read(const Buffer<T>& from, std::size_t elements) const {
        detail::read(from.device(), from.memory(), 0, data_.get(), elements * sizeof(T));
        return {data_.get(), elements * sizeof(T)};
    }
    template <class T>
    [[nodiscard]] std::span<const std::uint8_t> read(const Buffer<T>& from) const {
        return read(from, from.size());
    }

    /// Copies `parts` neighbouring parts of the bytes of a buffer from `offset` on, one after the other. Each is there
    /// when its event is complete. Asynchronous.
    [[nodiscard]] std::vector<cl::Event> read_in_parts(const Device& device, const cl::Buffer& from, std::size_t offset,
                                                       std::size_t bytes, std::size_t parts) const;
    /// Where a part begins.
    [[nodiscard]] static std::size_t begin_of_part(std::size_t bytes, std::size_t parts, std::size_t part) {
        return part == parts ? bytes : bytes * part / parts / alignment * alignment;
    }

private:
    static constexpr std::size_t alignment = 64;
    std::shared_ptr<std::uint8_t> data_;
};

/// Bytes of several buffers together.
template <class... Buffers>
[[nodiscard]] std::uint64_t buffer_bytes(const Buffers&... buffers) {
    return (std::uint64_t(0) + ... + buffers.bytes());
}

/// Bytes of all buffers that claray holds on the device.
[[nodiscard]] std::uint64_t bytes_in_use(const Device& device);
/// The most that they have been at once, on this device and its other queues.
[[nodiscard]] std::uint64_t most_bytes_in_use(const Device& device);
/// Bytes that claray can still allocate: the device's memory less what is in use; on CPUs at most what other programs
/// leave. What other programs take of a GPU is unknown.
[[nodiscard]] std::uint64_t bytes_available(const Device& device);

/// Returns whether the device can allocate a buffer of this size, even if it exceeds CL_DEVICE_MAX_MEM_ALLOC_SIZE:
/// NVIDIA's and AMD's drivers, for instance, report a quarter of the memory and often allow more.
[[nodiscard]] bool gives_buffer(const Device& device, std::uint64_t bytes);

/// For tests: the nth allocation or kernel run from now on fails as if the driver refused; 0: none fails. `error`:
/// OpenCL's number.
void fail_allocation(const Device& device, unsigned nth);
void fail_command(const Device& device, unsigned nth);
void fail_command_with(const Device& device, unsigned nth, int error);
/// Counts down and throws this OpenCL error at 1; does nothing at 0.
void fail_if_asked(unsigned& countdown, int error);

/// "12.3 MB", "4.56 GB"
[[nodiscard]] std::string size_text(std::uint64_t bytes);

}  // namespace claray
