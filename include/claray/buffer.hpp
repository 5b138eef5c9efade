// Typed device memory.
#pragma once

#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "claray/device.hpp"

#pragma GCC visibility push(default)
namespace claray {

namespace detail {
/// Allocates `bytes` bytes. Throws ErrorKind::device, with the bytes needed and available, if the device has too little
/// memory left.
[[nodiscard]] std::shared_ptr<cl::Buffer> allocate(const Device& device, std::size_t bytes);
/// Creates a sub-buffer that shares the memory. Throws ErrorKind::usage if `offset` is not aligned as the device
/// requires.
[[nodiscard]] std::shared_ptr<cl::Buffer> part(const cl::Buffer& whole, std::size_t offset, std::size_t bytes);
/// Retains a buffer of the host program. Throws ErrorKind::usage if it belongs to another context or holds fewer bytes.
[[nodiscard]] std::shared_ptr<cl::Buffer> adopt(const Device& device, cl_mem memory, std::size_t bytes);
/// Uses host memory in place on CPUs if it is aligned for float4; returns null elsewhere.
[[nodiscard]] std::shared_ptr<cl::Buffer> in_place(const Device& device, const void* host, std::size_t bytes);
/// Calls `use` with the first `bytes` bytes, which CPUs do not copy. Blocks.
void view(const Device& device, const cl::Buffer& buffer, std::size_t bytes,
          const std::function<void(const void*)>& use);
/// Blocking transfers of `bytes` bytes between the host and the bytes of `buffer` from `offset` on.
void write(const Device& device, const cl::Buffer& buffer, std::size_t offset, const void* data, std::size_t bytes);
void read(const Device& device, const cl::Buffer& buffer, std::size_t offset, void* data, std::size_t bytes);
/// Copies `bytes` bytes to `to`, starting at byte `offset` of it. Asynchronous.
void copy(const Device& device, const cl::Buffer& from, const cl::Buffer& to, std::size_t bytes,
          std::size_t offset = 0);
void fill_bytes(const Device& device, const cl::Buffer& buffer, unsigned pattern, std::size_t bytes);
}  // namespace detail

/// `size()` elements of plain data in device memory. A handle: copies share the memory, which is freed with the last
/// copy. An empty buffer allocates the bytes of one element, since OpenCL has no buffers of zero bytes.
template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>, "device memory holds plain data only");

public:
    Buffer() = default;
    /// Allocates uninitialized memory for `count` elements. Throws ErrorKind::device if the device has too little
    /// memory.
    Buffer(const Device& device, std::size_t count)
        : device_(std::make_shared<Device>(device)),
          memory_(detail::allocate(device, bytes_for(count))),
          size_(count) {}
    /// Allocates memory and copies `data` to the device. Blocks until the copy is done.
    Buffer(const Device& device, std::span<const T> data) : Buffer(device, data.size()) { write(data); }
    Buffer(const Device& device, const std::vector<T>& data) : Buffer(device, std::span<const T>(data)) {}
    /// A view of `count` elements of another buffer's memory, starting at `first_byte`, which must be a multiple of
    /// 1024. Do not pass both buffers to the same kernel.
    template <class U>
    Buffer(const Buffer<U>& whole, std::size_t first_byte, std::size_t count)
        : device_(std::make_shared<Device>(whole.device())),
          memory_(detail::part(whole.memory(), first_byte, bytes_for(count))),
          size_(count) {}

    /// A buffer of the host program, of the same context: its first `count` elements. It is retained. Throws
    /// ErrorKind::usage if it belongs to another context or is too small.
    [[nodiscard]] static Buffer adopt(const Device& device, cl_mem memory, std::size_t count) {
        return Buffer(device, detail::adopt(device, memory, bytes_for(count)), count);
    }
    /// Elements in host memory, which must outlive the buffer and its commands. CPUs use that memory in place; other
    /// devices get a copy of it. Blocks.
    [[nodiscard]] static Buffer over(const Device& device, std::span<const T> host) {
        auto memory = host.empty() ? nullptr : detail::in_place(device, host.data(), host.size_bytes());
        return memory ? Buffer(device, std::move(memory), host.size()) : Buffer(device, host);
    }
    /// As `over`, for results: nothing is copied to the device. Call `fetch` with the same memory to see what kernels
    /// wrote.
    [[nodiscard]] static Buffer under(const Device& device, std::span<T> host) {
        auto memory = host.empty() ? nullptr : detail::in_place(device, host.data(), host.size_bytes());
        if (!memory) return Buffer(device, host.size());
        Buffer buffer(device, std::move(memory), host.size());
        buffer.host_ = host.data();
        return buffer;
    }
    /// Waits for the kernels, and copies the results unless they were written in place. Blocks.
    void fetch(std::span<T> host) const {
        if (host_ != nullptr && host_ == host.data() && host.size() == size_)
            detail::view(*device_, memory(), bytes(), [](const void*) {});
        else
            read(host);
    }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return size_ * sizeof(T); }
    [[nodiscard]] bool allocated() const noexcept { return memory_ != nullptr; }
    [[nodiscard]] const cl::Buffer& memory() const noexcept {
        static const cl::Buffer none;
        return memory_ ? *memory_ : none;
    }
    [[nodiscard]] const Device& device() const { return *device_; }

    /// Copies `data` to the elements from `offset` on. Blocks. Throws ErrorKind::usage if the range exceeds the buffer.
    void write(std::span<const T> data, std::size_t offset = 0) {
        check(offset, data.size());
        if (!data.empty()) detail::write(*device_, memory(), offset * sizeof(T), data.data(), data.size_bytes());
    }
    /// Copies the elements from `offset` on to `data`. Blocks. Throws ErrorKind::usage if the range exceeds the buffer.
    void read(std::span<T> data, std::size_t offset = 0) const {
        check(offset, data.size());
        if (!data.empty()) detail::read(*device_, memory(), offset * sizeof(T), data.data(), data.size_bytes());
    }
    /// Returns a copy of all elements. Blocks.
    [[nodiscard]] std::vector<T> read() const {
        std::vector<T> data(size_);
        read(std::span<T>(data));
        return data;
    }
    /// Calls `use` with all elements, which CPUs do not copy. They are valid until it returns. Blocks.
    void view(const std::function<void(std::span<const T>)>& use) const {
        if (size_ == 0) return use({});
        detail::view(*device_, memory(), bytes(), [&](const void* at) { use({static_cast<const T*>(at), size_}); });
    }
    /// Sets every 32-bit word to `word`. Asynchronous. The element size must be a multiple of 4 bytes. Throws
    /// ErrorKind::usage if the buffer is not allocated.
    void fill(unsigned word) {
        static_assert(sizeof(T) % 4 == 0);
        if (!allocated()) throw Error(ErrorKind::usage, "cannot fill a buffer that was never allocated");
        detail::fill_bytes(*device_, memory(), word, bytes_for(size_));
    }
    /// Ensures room for at least `count` elements. The content is lost if the buffer grows.
    void reserve(const Device& device, std::size_t count) {
        if (!allocated() || size_ < count) *this = Buffer(device, count);
    }

private:
    Buffer(const Device& device, std::shared_ptr<cl::Buffer> memory, std::size_t count)
        : device_(std::make_shared<Device>(device)), memory_(std::move(memory)), size_(count) {}
    /// Returns the largest size on overflow; `allocate` refuses it.
    static std::size_t bytes_for(std::size_t count) {
        if (count > std::size_t(-1) / sizeof(T)) return std::size_t(-1);
        return (count ? count : 1) * sizeof(T);
    }
    void check(std::size_t offset, std::size_t count) const {
        if (offset > size_ || count > size_ - offset)
            throw Error(ErrorKind::usage, "buffer access past its end: " + std::to_string(count) + " elements from " +
                                              std::to_string(offset) + " on, of " + std::to_string(size_));
    }
    std::shared_ptr<Device> device_;
    std::shared_ptr<cl::Buffer> memory_;  // counted as used device memory
    std::size_t size_ = 0;
    const T* host_ = nullptr;  // of `under`, if it is used in place
};

}  // namespace claray
#pragma GCC visibility pop
