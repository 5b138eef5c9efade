// Copies large results to memory of the host, as fast as the device sends them.
#pragma once

#include "host/compute/memory.hpp"

namespace claray {

namespace detail {
/// From the first bytes of a buffer. Blocks.
void read_back(const Device& device, const cl::Buffer& from, void* to, std::size_t bytes);
/// The same on a device whose memory is not the host's, by page-locked memory that the device keeps.
void read_by_locked_memory(const Device& device, const cl::Buffer& from, void* to, std::size_t bytes);
}  // namespace detail

/// Copies from the beginning of a buffer. Several threads copy: one alone is slower than a GPU, and still slower where
/// it touches the pages for the first time. Blocks.
template <class T, class U>
void read_back(const Buffer<T>& from, std::span<U> to) {
    static_assert(std::is_trivially_copyable_v<U>);
    if (to.size_bytes() > from.bytes())
        throw Error(ErrorKind::usage,
                    "a buffer of " + std::to_string(from.bytes()) + " bytes has no " + std::to_string(to.size_bytes()));
    if (!to.empty()) detail::read_back(from.device(), from.memory(), to.data(), to.size_bytes());
}

/// Room for the elements of a vector, to be filled before there is one: a vector that initializes its elements costs
/// one thread another pass over them.
template <class T>
class VectorRoom {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    explicit VectorRoom(std::size_t count) : count_(count) { values_.reserve(count); }
    [[nodiscard]] std::span<T> span() { return {values_.data(), count_}; }
    /// The vector takes each element from where it will stand, for which the C library's memmove does nothing.
    [[nodiscard]] std::vector<T> take() {
        const std::span<T> filled = span();
        values_.assign(filled.begin(), filled.end());
        return std::move(values_);
    }

private:
    std::size_t count_;
    std::vector<T> values_;
};

/// All elements.
template <class T>
std::vector<T> read_back(const Buffer<T>& from) {
    VectorRoom<T> values(from.size());
    read_back(from, values.span());
    return values.take();
}

}  // namespace claray
