// Stable radix sort of keys with 32-bit values on the device: kernels/sort/radix_sort.cl on GPUs, bucket_sort.cl on
// CPUs.
#pragma once

#include "host/compute/programs/kernel_set.hpp"

namespace claray {

/// Holds the kernels and scratch memory for repeated sorts of up to `capacity` keys.
/// Key is std::uint32_t or std::uint64_t.
template <class Key>
class RadixSort {
public:
    struct Config {
        bool onesweep = true;                 ///< the GPU's schedule; otherwise the CPU's, buckets
        unsigned key_bits = 8 * sizeof(Key);  ///< only the lowest bits of the keys are compared
    };
    /// The tuning table's schedule for the device.
    [[nodiscard]] static Config config_for(const Device& device);

    RadixSort(const Device& device, std::size_t capacity, const Config& config);
    [[nodiscard]] static KernelsOf<RadixSort> kernels(const Device& device, bool onesweep);

    /// Sorts the first `count` keys; values[i] receives the former position of keys[i]. Both buffers must hold at least
    /// `count` elements; the initial content of `values` is ignored. Asynchronous.
    void sort(Buffer<Key>& keys, Buffer<std::uint32_t>& values, std::size_t count);
    [[nodiscard]] std::uint64_t bytes() const {
        return other_keys_.bytes() + other_values_.bytes() + histogram_.bytes();
    }

private:
    void sort_onesweep(Buffer<Key>& keys, Buffer<std::uint32_t>& values, std::uint32_t count);
    void sort_by_buckets(Buffer<Key>& keys, Buffer<std::uint32_t>& values, std::uint32_t count);

    Config config_;
    std::size_t capacity_;
    unsigned tile_ = 0, runs_ = 0, shares_ = 0, digit_groups_ = 0;
    Buffer<Key> other_keys_;
    Buffer<std::uint32_t> other_values_, histogram_;  // followed by tickets and look-back words
    Kernel count_all_, scan_, sort_digit_, count_buckets_, scan_buckets_, fill_buckets_, sort_buckets_;
};

}  // namespace claray
