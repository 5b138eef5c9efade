// The trace file is JSON in the Trace Event Format.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "claray/io.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using nlohmann::json;

TEST(Trace, EventsAreInMicrosecondsFromTheFirst) {
    const test::TemporaryFolder folder;
    const std::uint64_t origin = 1'700'000'000'000'000'000u;
    write_trace(folder / "t.json",
                {{"sort \"digits\"", origin + 500, origin + 2000, origin + 5500},
                 {"build", origin, origin + 6000, origin + 6001}},
                "pthread-\xff CPU");
    const json trace = json::parse(test::read_file(folder / "t.json"));
    const json& events = trace.at("traceEvents");
    ASSERT_EQ(events.size(), 4u);
    EXPECT_EQ(events[0].at("ph"), "M");
    EXPECT_EQ(events[0].at("args").at("name"), "pthread-\xef\xbf\xbd CPU");
    EXPECT_EQ(events[2].at("ph"), "X");
    EXPECT_EQ(events[2].at("name"), "sort \"digits\"");
    EXPECT_DOUBLE_EQ(events[2].at("ts"), 2.0);
    EXPECT_DOUBLE_EQ(events[2].at("dur"), 3.5);
    EXPECT_DOUBLE_EQ(events[2].at("args").at("queued_us"), 0.5);
    EXPECT_DOUBLE_EQ(events[3].at("dur"), 0.001);
    for (const json& event : events) EXPECT_EQ(event.at("pid"), 1);
}

TEST(Trace, NoRecordsAreAValidTrace) {
    const test::TemporaryFolder folder;
    write_trace(folder / "t.json", {}, "none");
    EXPECT_EQ(json::parse(test::read_file(folder / "t.json")).at("traceEvents").size(), 2u);
}

}  // namespace
}  // namespace claray
