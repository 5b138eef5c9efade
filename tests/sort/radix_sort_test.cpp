// Sorting on GPUs, sort/radix_sort.cl, and on CPUs, sort/bucket_sort.cl.
#include "host/sort/radix_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "tests/support/device.hpp"

namespace claray::test {
namespace {

enum class Keys { random, equal, few, ascending, descending, high_bits, low_bits, clustered, repeated };
constexpr Keys all_kinds[] = {Keys::random,    Keys::equal,    Keys::few,       Keys::ascending, Keys::descending,
                              Keys::high_bits, Keys::low_bits, Keys::clustered, Keys::repeated};

template <class Key>
std::vector<Key> make_keys(Keys kind, std::size_t count) {
    std::mt19937_64 random(count);
    std::vector<Key> keys(count);
    for (std::size_t i = 0; i < count; ++i) switch (kind) {
            case Keys::random: keys[i] = Key(random()); break;
            case Keys::equal: keys[i] = 42; break;
            case Keys::few: keys[i] = Key(random() % 3) << 20; break;
            case Keys::ascending: keys[i] = Key(i); break;
            case Keys::descending: keys[i] = Key(count - i); break;
            case Keys::high_bits: keys[i] = ~Key(random() % 5); break;
            case Keys::low_bits: keys[i] = Key(random() % 50'000); break;
            // Most lie close together, with the ends of the range far away: the teapot in the stadium.
            case Keys::clustered: keys[i] = i % 10 == 0 ? Key(random()) : Key(0xabcd0000) | Key(random() % 4096); break;
            // Several clusters of many equal keys that differ only in their lowest bits.
            case Keys::repeated: keys[i] = (Key(random() % 7) << (8 * sizeof(Key) - 14)) | Key(random() % 3); break;
        }
    return keys;
}

template <class Key>
void expect_stable_sort(const std::vector<Key>& keys, bool onesweep, unsigned bits = 8 * sizeof(Key),
                        const Device& device = test::device()) {
    const std::size_t count = keys.size();
    const Key mask = Key(~Key(0)) >> (8 * sizeof(Key) - bits);
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return (keys[a] & mask) < (keys[b] & mask); });

    RadixSort<Key> sorter(device, count, {.onesweep = onesweep, .key_bits = bits});
    for (int round = 0; round < 2; ++round) {  // the second sort meets used scratch memory
        Buffer<Key> device_keys(device, keys);
        Buffer<std::uint32_t> device_values(device, count);
        sorter.sort(device_keys, device_values, count);
        ASSERT_EQ(device_values.read(), order) << count << " keys, round " << round;
        std::vector<Key> sorted(count);
        for (std::size_t i = 0; i < count; ++i) sorted[i] = keys[order[i]];
        ASSERT_EQ(device_keys.read(), sorted);
    }
}

class RadixSortTest : public testing::TestWithParam<bool> {};

TEST_P(RadixSortTest, EqualsStdStableSort) {
    for (const Keys kind : all_kinds)
        for (const std::size_t count : {1u, 2u, 31u, 255u, 257u, 3072u, 3073u, 20011u}) {
            expect_stable_sort(make_keys<std::uint32_t>(kind, count), GetParam());
            expect_stable_sort(make_keys<std::uint64_t>(kind, count), GetParam());
        }
}

TEST_P(RadixSortTest, ManyTiles) {
    expect_stable_sort(make_keys<std::uint64_t>(Keys::random, 300'007), GetParam());
    expect_stable_sort(make_keys<std::uint32_t>(Keys::few, 300'007), GetParam());
}

/// Buckets too large to be sorted in the cache at once, with digits at all positions.
TEST_P(RadixSortTest, LargeBuckets) {
    for (const Keys kind : all_kinds) {
        expect_stable_sort(make_keys<std::uint64_t>(kind, 50'021), GetParam());
        expect_stable_sort(make_keys<std::uint32_t>(kind, 50'021), GetParam());
    }
}

/// Digits are of eight bits on GPUs, so that only multiples of eight bits are left out there.
TEST_P(RadixSortTest, ComparesOnlyTheLowestBits) {
    for (const unsigned bits : {8u, 16u, 24u, 32u, 48u, 56u})
        for (const Keys kind : all_kinds) {
            SCOPED_TRACE(bits);
            expect_stable_sort(make_keys<std::uint64_t>(kind, 9001), GetParam(), bits);
            if (bits <= 32) expect_stable_sort(make_keys<std::uint32_t>(kind, 9001), GetParam(), bits);
        }
}

/// So few buckets that nearly all must be split, again and again.
TEST(RadixSort, SplitsBuckets) {
    const Device few = Device::open(std::to_string(device().info().index));
    few.set_tuning("sort/bucket_sort", "BUCKET_BITS", 4);
    for (const Keys kind : all_kinds) {
        expect_stable_sort(make_keys<std::uint64_t>(kind, 30'011), false, 64, few);
        expect_stable_sort(make_keys<std::uint32_t>(kind, 30'011), false, 32, few);
    }
}

TEST_P(RadixSortTest, SortsNothing) {
    RadixSort<std::uint32_t> sorter(device(), 10, {.onesweep = GetParam()});
    Buffer<std::uint32_t> keys(device(), 10), values(device(), 10);
    EXPECT_NO_THROW(sorter.sort(keys, values, 0));
}

TEST_P(RadixSortTest, RefusesMoreThanItsCapacity) {
    RadixSort<std::uint32_t> sorter(device(), 10, {.onesweep = GetParam()});
    Buffer<std::uint32_t> keys(device(), 11), values(device(), 11);
    EXPECT_THROW(sorter.sort(keys, values, 11), Error);
}

INSTANTIATE_TEST_SUITE_P(Schedules, RadixSortTest, testing::Values(false, true),
                         [](const auto& schedule) { return schedule.param ? "Onesweep" : "Buckets"; });

}  // namespace
}  // namespace claray::test
