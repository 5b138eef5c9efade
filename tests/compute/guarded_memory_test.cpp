#include <gtest/gtest.h>

#include <cmath>

#include "host/compute/memory.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

TEST(GuardedMemory, CountsBuffersThatAreWrittenBeyondTheirEnd) {
    const GuardedMemory memory(device());
    for (const std::size_t count : {1u, 7u, 4096u, 2'000'000u}) {
        Buffer<float> within(device(), count), beyond(device(), count);
        within.fill(0);
        EXPECT_TRUE(std::isnan(beyond.read()[count - 1])) << "nothing was written";
        const float one = 1.f;
        detail::write(device(), beyond.memory(), beyond.bytes(), &one, sizeof one);
    }
    EXPECT_EQ(memory.overruns(), 4u);
}

TEST(GuardedMemory, EndsWithItsObject) {
    {
        const GuardedMemory outer(device());
        const Buffer<float> kept(device(), 8);
        {
            const GuardedMemory inner(device());
            const float one = 1.f;
            const Buffer<float> beyond(device(), 8);
            detail::write(device(), kept.memory(), kept.bytes(), &one, sizeof one);
            EXPECT_EQ(inner.overruns(), 0u) << "that buffer is of the outer one";
        }
        EXPECT_EQ(outer.overruns(), 0u) << "the buffer is still there";
    }
    const Buffer<float> plain(device(), 8);
    EXPECT_EQ(plain.memory().getInfo<CL_MEM_SIZE>(), plain.bytes());
}

}  // namespace
}  // namespace claray::test
