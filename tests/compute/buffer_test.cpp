#include "claray/buffer.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

TEST(Buffers, RoundTrip) {
    for (const std::size_t count : {0u, 1u, 7u, 1000u, 65537u}) {
        std::vector<std::uint64_t> data(count);
        std::iota(data.begin(), data.end(), 0x123456789abcull);
        const Buffer<std::uint64_t> buffer(device(), data);
        EXPECT_EQ(buffer.size(), count);
        EXPECT_EQ(buffer.bytes(), 8 * count);
        EXPECT_TRUE(buffer.allocated());
        EXPECT_EQ(buffer.read(), data);
        std::vector<std::uint64_t> seen;
        buffer.view([&](std::span<const std::uint64_t> all) { seen.assign(all.begin(), all.end()); });
        EXPECT_EQ(seen, data);
    }
}

TEST(Buffers, PartsAtAnOffset) {
    Buffer<int> buffer(device(), std::vector<int>{0, 1, 2, 3, 4, 5});
    buffer.write(std::vector<int>{30, 40}, 3);
    std::vector<int> part(3);
    buffer.read(part, 2);
    EXPECT_EQ(part, (std::vector<int>{2, 30, 40}));
    EXPECT_EQ(buffer.read(), (std::vector<int>{0, 1, 2, 30, 40, 5}));
}

TEST(Buffers, CopiesShareTheMemory) {
    Buffer<int> buffer(device(), std::vector<int>{1, 2});
    const Buffer<int> same = buffer;
    buffer.write(std::vector<int>{5}, 1);
    EXPECT_EQ(same.read(), (std::vector<int>{1, 5}));
}

TEST(Buffers, FillSetsEveryWord) {
    Buffer<std::uint64_t> buffer(device(), 3);
    buffer.fill(0xdeadbeefu);
    EXPECT_EQ(buffer.read(), std::vector<std::uint64_t>(3, 0xdeadbeefdeadbeefull));
}

/// The flags of the mapping of this process that contains the address (Linux, proc_pid_smaps(5)).
std::string mapping_flags(const void* address) {
    std::ifstream maps("/proc/self/smaps");
    bool inside = false;
    for (std::string line; std::getline(maps, line);) {
        unsigned long long begin = 0, end = 0;
        if (std::sscanf(line.c_str(), "%llx-%llx ", &begin, &end) == 2)
            inside = begin <= std::uintptr_t(address) && std::uintptr_t(address) < end;
        else if (inside && line.starts_with("VmFlags:"))
            return line;
    }
    return {};
}

TEST(Buffers, LargeOnesAskForHugePagesOnCpus) {
    if (device().info().type != DeviceType::cpu) GTEST_SKIP() << "the memory of CPUs only";
    if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage")) GTEST_SKIP() << "this system has none";
    const Buffer<std::uint8_t> buffer(device(), std::vector<std::uint8_t>(std::size_t(9) << 20, 7));
    void* const mapped = device().queue().enqueueMapBuffer(buffer.memory(), CL_TRUE, CL_MAP_READ, 0, buffer.bytes());
    const std::string flags = mapping_flags(static_cast<const char*>(mapped) + (std::size_t(3) << 20));
    device().queue().enqueueUnmapMemObject(buffer.memory(), mapped);
    device().finish();
    EXPECT_NE(flags.find(" hg"), std::string::npos) << flags;
    EXPECT_EQ(buffer.read(), std::vector<std::uint8_t>(buffer.size(), 7));
}

TEST(Buffers, ReserveGrowsAndNeverShrinks) {
    Buffer<int> buffer;
    EXPECT_FALSE(buffer.allocated());
    buffer.reserve(device(), 10);
    EXPECT_EQ(buffer.size(), 10u);
    const cl_mem memory = buffer.memory()();
    buffer.reserve(device(), 5);
    EXPECT_EQ(buffer.memory()(), memory);
    buffer.reserve(device(), 11);
    EXPECT_EQ(buffer.size(), 11u);
}

TEST(Buffers, AccessPastTheEndIsRefused) {
    Buffer<int> buffer(device(), 4);
    std::vector<int> data(2);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "past its end", [&] { buffer.write(data, 3); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "past its end", [&] { buffer.read(data, 3); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "past its end", [&] { buffer.read(data, std::size_t(-1)); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "past its end", [&] { Buffer<int>().write(data); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "never allocated", [&] { Buffer<int>().fill(0); }));
}

TEST(Buffers, TooLargeNamesWhatIsNeededAndWhatThereIs) {
    const auto is_refused = [](std::size_t limit) {
        EXPECT_TRUE(
            throws_error(ErrorKind::device, "out of device memory", [&] { Buffer<char>(device(), limit + 1); }));
        EXPECT_TRUE(throws_error(ErrorKind::device, device().info().name, [&] { Buffer<double>(device(), limit); }));
    };
    is_refused(device().info().memory);
    // Drivers of GPUs may give more in one buffer than they say.
    if (device().info().type == DeviceType::cpu) is_refused(device().info().max_allocation);
    // 2^61 doubles and one more are 8 bytes modulo 2^64.
    EXPECT_TRUE(throws_error(ErrorKind::device, "out of device memory",
                             [&] { Buffer<double>(device(), (std::size_t(1) << 61) + 1); }));
}

}  // namespace
}  // namespace claray::test
