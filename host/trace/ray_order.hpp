// An order in which rays of all directions are faster to trace on CPUs: rays with similar origins and directions are
// neighbours.
#pragma once

#include <optional>

#include "claray/bvh.hpp"
#include "host/sort/radix_sort.hpp"

namespace claray {

class RayOrder {
public:
    explicit RayOrder(const Device& device);

    /// Whether rays are in no order by which neighbours meet the same parts of a structure, by a sample. Waits for it.
    [[nodiscard]] bool has_none(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count);
    /// The indices of `size` of `count` rays, from all parts of them.
    const Buffer<std::uint32_t>& sample(std::uint32_t count, std::uint32_t size);
    /// The indices of rays 0 .. count - 1 in that order; asynchronous. Takes 16 bytes per ray, which it keeps.
    const Buffer<std::uint32_t>& sort(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count);

private:
    Device device_;
    Buffer<std::uint32_t> keys_, order_, sample_, answer_;
    std::optional<RadixSort<std::uint32_t>> sort_;
    Kernel make_keys_, compare_;
};

}  // namespace claray
