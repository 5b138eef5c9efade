// Reports of results: JSON is written without a library, and must be what a library reads.
#include "host/verify/reports.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace claray::test {
namespace {

TEST(VerifyReports, JsonHoldsAnyTextAndNumber) {
    VerifyResult result;
    result.name = "case", result.seed = UINT64_MAX, result.seconds = 0.1, result.command = "claray verify";
    result.checks = {{"a \"quoted\" \\ name", 7, 1e-300, 0.25, "ulp \xc3\xbc"},
                     {"not finite", 1, std::numeric_limits<double>::quiet_NaN(), 0, "", true}};
    result.facts = {{"hash", "line 1\nline 2\t\x01"}, {"bytes", "\xff\xfe"}};
    result.failures = {};
    result.kernels = {"one", "two"};
    DeviceInfo device;
    device.name = "GPU \"7\"", device.platform = "a\\b", device.driver = "1.0";
    const std::vector<VerifyResult> results = {result};
    const auto read =
        nlohmann::json::parse(verify::json_of(device, {.effort = Effort::full, .kernels = true}, results, 1.5));
    EXPECT_EQ(read.at("device"), device.name);
    EXPECT_EQ(read.at("platform"), device.platform);
    EXPECT_EQ(read.at("driver"), "1.0");
    EXPECT_EQ(read.at("effort"), "full");
    EXPECT_EQ(read.at("seconds"), 1.5);
    EXPECT_EQ(read.at("holds"), false) << "NaN is no result";
    const auto& one = read.at("cases").at(0);
    EXPECT_EQ(one.at("seed"), UINT64_MAX);
    EXPECT_EQ(one.at("seconds"), 0.1);
    EXPECT_EQ(one.at("checks")[0].at("what"), result.checks[0].what);
    EXPECT_EQ(one.at("checks")[0].at("unit"), result.checks[0].unit);
    EXPECT_EQ(one.at("checks")[0].at("worst"), 1e-300);
    EXPECT_EQ(one.at("checks")[0].at("holds"), true);
    EXPECT_TRUE(one.at("checks")[1].at("worst").is_null());
    EXPECT_EQ(one.at("checks")[1].at("time"), true);
    EXPECT_EQ(one.at("facts").at("hash"), "line 1\nline 2\t?");
    EXPECT_EQ(one.at("facts").at("bytes"), "??");
    EXPECT_TRUE(one.at("failures").empty());
    EXPECT_EQ(one.at("kernels"), (std::vector<std::string>{"one", "two"}));
}

}  // namespace
}  // namespace claray::test
