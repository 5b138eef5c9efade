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

    /// The indices of rays 0 .. count - 1 in that order; asynchronous.
    const Buffer<std::uint32_t>& sort(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count);
    [[nodiscard]] std::uint32_t capacity() const { return std::uint32_t(keys_.size()); }

private:
    Buffer<std::uint32_t> keys_, order_;
    RadixSort<std::uint32_t> sort_;
    Kernel make_keys_;
};

}  // namespace claray
