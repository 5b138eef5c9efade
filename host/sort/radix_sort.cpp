#include "host/sort/radix_sort.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr const char* radix_file = "sort/radix_sort.cl";
constexpr const char* stage = "sort/radix_sort";
constexpr const char* bucket_file = "sort/bucket_sort.cl";
constexpr const char* bucket_stage = "sort/bucket_sort";
constexpr unsigned digits = 256, digit_bits = 8, group_size = digits;  // one work-item per digit
constexpr std::size_t onesweep_limit = std::size_t(1) << 30;           // a look-back word counts in 30 bits

/// The largest number of keys per work-item for which the tile, the counters of each warp and two rows of scratch fit
/// in the group's local memory.
unsigned items_that_fit(const Device& device, std::size_t key_bytes, unsigned wanted) {
    const std::size_t fixed = 4 * digits * (group_size / 32 + 3);
    const std::size_t memory = device.info().local_memory;
    const std::size_t most = memory > fixed ? (memory - fixed) / (group_size * key_bytes) : 0;
    if (most == 0)
        throw Error(ErrorKind::device, "cannot sort on " + device.info().name + ": only " + std::to_string(memory) +
                                           " bytes of local memory");
    return unsigned(std::min<std::size_t>(wanted, most));
}

}  // namespace

template <class Key>
typename RadixSort<Key>::Config RadixSort<Key>::config_for(const Device& device) {
    return {.onesweep = device.tuning(stage, "ONESWEEP") != 0};
}

template <class Key>
RadixSort<Key>::RadixSort(const Device& device, std::size_t capacity, const Config& config)
    : config_(config), capacity_(capacity), other_keys_(device, capacity), other_values_(device, capacity) {
    if (config.onesweep && capacity >= onesweep_limit)
        throw Error(ErrorKind::user, "cannot sort " + std::to_string(capacity) + " keys: the limit is 2^30 - 1");
    if (config_.onesweep) {
        tile_ = group_size * items_that_fit(device, sizeof(Key), device.tuning(stage, "ITEMS"));
        digit_groups_ = 4 * device.info().compute_units;
        const std::size_t tiles = (capacity + tile_ - 1) / tile_;
        histogram_ = Buffer<std::uint32_t>(device, sizeof(Key) * (digits + 1 + tiles * digits));
    } else {
        const unsigned units = device.info().compute_units;
        runs_ = std::max(1u, units * device.tuning(bucket_stage, "RUNS_PER_UNIT"));
        shares_ = std::max(1u, units * device.tuning(bucket_stage, "SHARES_PER_UNIT"));
        histogram_ = Buffer<std::uint32_t>(device, std::size_t(runs_) << device.tuning(bucket_stage, "BUCKET_BITS"));
    }
    load(device, kernels(device, config_.onesweep), *this);
}

template <class Key>
KernelsOf<RadixSort<Key>> RadixSort<Key>::kernels(const Device& device, bool onesweep) {
    Defines defines = {{"KEY_BITS", std::to_string(8 * sizeof(Key))}};
    if (!onesweep)
        return {{&RadixSort::count_buckets_, {bucket_file, "count_buckets", defines}},
                {&RadixSort::scan_buckets_, {bucket_file, "scan_buckets", defines}},
                {&RadixSort::fill_buckets_, {bucket_file, "fill_buckets", defines}},
                {&RadixSort::sort_buckets_, {bucket_file, "sort_buckets", defines}}};
    defines.emplace_back("ITEMS", std::to_string(items_that_fit(device, sizeof(Key), device.tuning(stage, "ITEMS"))));
    return {{&RadixSort::count_all_, {radix_file, "count_all_digits", defines}},
            {&RadixSort::scan_, {radix_file, "scan_histogram", defines}},
            {&RadixSort::sort_digit_, {radix_file, "sort_digit", defines}}};
}

template <class Key>
void RadixSort<Key>::sort(Buffer<Key>& keys, Buffer<std::uint32_t>& values, std::size_t count) {
    if (count > capacity_ || count > keys.size() || count > values.size())
        throw Error(ErrorKind::usage, "cannot sort " + std::to_string(count) + " keys: the capacity is " +
                                          std::to_string(std::min({capacity_, keys.size(), values.size()})));
    if (count == 0) return;
    if (config_.onesweep)
        sort_onesweep(keys, values, std::uint32_t(count));
    else
        sort_by_buckets(keys, values, std::uint32_t(count));
}

template <class Key>
void RadixSort<Key>::sort_onesweep(Buffer<Key>& keys, Buffer<std::uint32_t>& values, std::uint32_t count) {
    histogram_.fill(0);
    const std::uint32_t tiles = (count + tile_ - 1) / tile_;
    const std::size_t counting = std::min<std::size_t>(std::size_t(digit_groups_) * group_size, count);
    count_all_.run({counting, group_size}, arg("keys", keys), count, arg("histogram", histogram_));
    scan_.run({sizeof(Key) * digits, digits}, histogram_);
    const unsigned passes = (config_.key_bits + digit_bits - 1) / digit_bits;
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        const Buffer<std::uint32_t> positions = pass == 0 ? Buffer<std::uint32_t>() : values;
        sort_digit_.run({std::size_t(tiles) * group_size, group_size}, arg("keys_in", keys),
                        arg("values_in", positions), arg("keys_out", other_keys_), arg("values_out", other_values_),
                        count, std::uint32_t(pass * digit_bits), pass, arg("histogram", histogram_), tiles);
        std::swap(keys, other_keys_);
        std::swap(values, other_values_);
    }
}

template <class Key>
void RadixSort<Key>::sort_by_buckets(Buffer<Key>& keys, Buffer<std::uint32_t>& values, std::uint32_t count) {
    const std::uint32_t bits = config_.key_bits, runs = runs_;
    count_buckets_.run({runs, 1}, arg("keys", keys), count, bits, runs, arg("counts", histogram_));
    scan_buckets_.run({1, 1}, runs, histogram_);
    fill_buckets_.run({runs, 1}, arg("keys", keys), arg("keys_out", other_keys_), arg("values_out", other_values_),
                      count, bits, runs, arg("counts", histogram_));
    sort_buckets_.run({shares_, 1}, arg("keys", other_keys_), arg("values", other_values_), arg("keys_out", keys),
                      arg("values_out", values), count, bits, runs, arg("counts", histogram_));
}

template class RadixSort<std::uint32_t>;
template class RadixSort<std::uint64_t>;

}  // namespace claray
