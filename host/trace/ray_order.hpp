// An order in which rays of all directions are faster to trace on CPUs: rays with similar origins and directions are
// neighbours.
#pragma once

#include "claray/bvh.hpp"
#include "host/sort/radix_sort.hpp"

namespace claray {

class RayOrder {
public:
    /// For up to `capacity` rays; needs 16 bytes per ray.
    RayOrder(const Device& device, std::uint32_t capacity);

    /// Whether rays are in no order by which neighbours meet the same parts of a structure, by a sample. Waits for it.
    [[nodiscard]] bool has_none(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count);
    /// The indices of `sample_size` rays from all parts of so many, at least 65,536.
    const Buffer<std::uint32_t>& sample(std::uint32_t count);
    /// The indices of rays 0 .. count - 1 in that order; asynchronous.
    const Buffer<std::uint32_t>& sort(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count);
    [[nodiscard]] std::uint32_t capacity() const { return std::uint32_t(keys_.size()); }

    static constexpr std::uint32_t sample_size = 4096;

private:
    Buffer<std::uint32_t> keys_, order_, sample_, answer_;
    RadixSort<std::uint32_t> sort_;
    Kernel make_keys_, compare_;
};

}  // namespace claray
