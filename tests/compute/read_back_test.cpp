// Large results copied to the host by several threads.
#include "host/compute/read_back.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

std::vector<std::uint32_t> numbers(std::size_t count) {
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 1u);
    return all;
}

/// Less than a part, several parts of unequal sizes, and more than the page-locked memory that a device keeps.
TEST(ReadBack, BringsEveryByte) {
    for (const std::size_t count : {1u, 1000u, 786'433u, 17'000'001u}) {
        const std::vector<std::uint32_t> all = numbers(count);
        const Buffer<std::uint32_t> buffer(device(), all);
        EXPECT_TRUE(read_back(buffer) == all) << count;
        std::vector<std::uint32_t> locked(count + 1);
        detail::read_by_locked_memory(device(), buffer.memory(), locked.data(), 4 * count);
        EXPECT_EQ(locked.back(), 0u) << "nothing is written behind";
        locked.pop_back();
        EXPECT_TRUE(locked == all) << count;
    }
}

TEST(ReadBack, TakesTheFirstOfABufferAsOtherElements) {
    const Buffer<float> buffer(device(), std::vector<float>{1, 2, 3, 4, 5, 6, 7});
    std::vector<glm::vec3> points(2);
    read_back(buffer, std::span(points));
    EXPECT_EQ(points[1], glm::vec3(4, 5, 6));
    points.resize(3);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "a buffer of 28 bytes has no 36",
                             [&] { read_back(buffer, std::span(points)); }));
}

TEST(ReadBack, RoomBecomesAVectorWhereItIs) {
    VectorRoom<std::uint32_t> room(1000);
    const std::uint32_t* const begin = room.span().data();
    std::iota(room.span().begin(), room.span().end(), 1u);
    const std::vector<std::uint32_t> vector = room.take();
    EXPECT_EQ(vector.data(), begin);
    EXPECT_EQ(vector, numbers(1000));
}

}  // namespace
}  // namespace claray::test
