// Morton codes: claray/shared/morton.h, bvh/morton_codes.cl.
#include "claray/shared/morton.h"

#include <gtest/gtest.h>

#include <random>

namespace claray::test {
namespace {

std::uint64_t interleave(std::uint32_t x, std::uint32_t y, std::uint32_t z, unsigned bits) {
    std::uint64_t code = 0;
    for (unsigned bit = 0; bit < bits; ++bit)
        code |= (std::uint64_t(x >> bit & 1) << (3 * bit + 2)) | (std::uint64_t(y >> bit & 1) << (3 * bit + 1)) |
                (std::uint64_t(z >> bit & 1) << (3 * bit));
    return code;
}

TEST(Morton, EqualsBitByBitInterleaving) {
    std::mt19937 random(1);
    for (int i = 0; i < 10'000; ++i) {
        const std::uint32_t x = random(), y = random(), z = random();
        ASSERT_EQ(morton30(x & 1023, y & 1023, z & 1023), interleave(x, y, z, 10));
        ASSERT_EQ(morton63(x & 2097151, y & 2097151, z & 2097151), interleave(x, y, z, 21));
    }
}

}  // namespace
}  // namespace claray::test
