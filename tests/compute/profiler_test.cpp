#include "claray/profiler.hpp"

#include <gtest/gtest.h>

#include "claray/program.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

constexpr const char* kernel_source =
    "kernel void spin(global float* x, uint rounds) {"
    "    float v = x[get_global_id(0)];"
    "    for (uint i = 0; i < rounds; ++i) v = v * 0.999f + 1.0f;"
    "    x[get_global_id(0)] = v;"
    "}";

TEST(ProfilerTest, CountsAndTimesByName) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    Profiler& profiler = fresh.profiler();
    Buffer<float> data(fresh, std::vector<float>(1024));
    Kernel spin = compile_kernel(fresh, kernel_source, "spin");
    for (int i = 0; i < 3; ++i) spin.run({1024, 64}, data, 100u);
    (void)data.read();

    const auto& summary = profiler.summary();
    EXPECT_EQ(summary.at("spin").count, 3u);
    EXPECT_EQ(summary.at("write_buffer").count, 1u);
    EXPECT_EQ(summary.at("read_buffer").count, 1u);
    EXPECT_GT(profiler.milliseconds("spin"), 0.0);
    EXPECT_EQ(profiler.milliseconds("never ran"), 0.0);
    double total = 0;
    for (const auto& [name, of_name] : summary) total += of_name.milliseconds;
    EXPECT_DOUBLE_EQ(profiler.total_milliseconds(), total);
    EXPECT_TRUE(profiler.records().empty());  // not kept unless asked for

    profiler.reset();
    EXPECT_TRUE(profiler.summary().empty());
}

TEST(ProfilerTest, TimeGrowsWithTheWork) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    Buffer<float> data(fresh, std::vector<float>(4096));
    Kernel spin = compile_kernel(fresh, kernel_source, "spin");
    spin.run({4096, 64}, data, 1u);  // drivers finish compiling at the first run
    const auto time = [&](unsigned rounds) {
        fresh.profiler().reset();
        spin.run({4096, 64}, data, rounds);
        return fresh.profiler().milliseconds("spin");
    };
    EXPECT_GT(time(100'000), 3 * time(1'000));
}

TEST(ProfilerTest, RecordsAreInOrderAndEndAfterTheyStart) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.profiler().keep_records(true);
    Buffer<float> data(fresh, std::vector<float>(64));
    Kernel spin = compile_kernel(fresh, kernel_source, "spin");
    for (int i = 0; i < 5; ++i) spin.run({64}, data, 10u);
    fresh.finish();
    const std::vector<ProfileRecord>& records = fresh.profiler().records();
    ASSERT_EQ(records.size(), 6u);
    EXPECT_EQ(records[0].name, "write_buffer");
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_LE(records[i].queued, records[i].start);
        EXPECT_LE(records[i].start, records[i].end);
        if (i > 0) {
            EXPECT_LE(records[i - 1].end, records[i].start);
        }
    }
}

TEST(ProfilerTest, MoreCommandsThanItHoldsBack) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    Buffer<float> data(fresh, 1);
    for (int i = 0; i < 10'000; ++i) data.fill(0);
    EXPECT_EQ(fresh.profiler().summary().at("fill_buffer").count, 10'000u);
}

TEST(ProfilerTest, DisabledItRemembersNothing) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.profiler().enable(false);
    Buffer<float>(fresh, 1).fill(0);
    fresh.profiler().record("a command", [](const cl::Event* event) { EXPECT_EQ(event, nullptr); });
    EXPECT_TRUE(fresh.profiler().summary().empty());
    fresh.profiler().enable(true);
    Buffer<float>(fresh, 1).fill(0);
    EXPECT_EQ(fresh.profiler().summary().at("fill_buffer").count, 1u);
}

}  // namespace
}  // namespace claray::test
