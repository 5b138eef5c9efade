// An order in which rays that run in all directions are faster to trace on CPUs: those that start and run alike
// together.
#pragma once

#include "claray/bvh.hpp"
#include "host/sort/radix_sort.hpp"

namespace claray {

class RayOrder {
public:
    /// For up to `capacity` rays; takes 16 bytes for each.
    RayOrder(const Device& device, std::uint32_t capacity);

    /// The numbers of rays 0 .. count - 1 in that order; enqueued.
    const Buffer<std::uint32_t>& sort(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count);
    [[nodiscard]] std::uint32_t capacity() const { return std::uint32_t(keys_.size()); }

private:
    Buffer<std::uint32_t> keys_, order_;
    RadixSort<std::uint32_t> sort_;
    Kernel make_keys_;
};

}  // namespace claray
