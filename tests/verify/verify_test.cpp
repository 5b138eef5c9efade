// Every case of `claray verify`, with few rays, and without bars for times. Each kernel of these cases is tested by
// those behind it: verify/arithmetic.cl (arithmetic), verify/bsdf/albedo.cl (furnace and energy of BSDFs),
// verify/bsdf/reciprocity.cl (reciprocity), verify/bsdf/samples.cl (densities and values of BSDFs), verify/edge_rays.cl
// (edges, vertices), verify/float_atomics.cl (atomics), verify/gbuffer_codes.cl (packed-normals, depth-to-position),
// verify/graze_boxes.cl (boxes), verify/harmonics.cl (spherical-harmonics), verify/leave_surface.cl
// (self-intersection), verify/look_back.cl (sort), verify/microfacets.cl (fresnel, ggx-density, ggx-energy),
// verify/random_numbers.cl (random-numbers, light-descents), verify/shading_normals.cl (shading normals),
// verify/functions.cl (functions, approximations), verify/near_lights.cl (light-lists, hot-spots),
// verify/solutions.cl (solutions), verify/wave_equation.cl (waves).
#include "claray/verify.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "host/verify/run.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"

namespace claray {

void PrintTo(const VerifyCase& c, std::ostream* out) { *out << c.name; }

}  // namespace claray

namespace claray::test {
namespace {

/// A case for each kernel; "-" for those of studies and tests.
std::map<std::string, std::string> cases_of_kernels() {
    std::ifstream file(CLARAY_SOURCE_DIR "/tests/verify/kernels.txt");
    std::map<std::string, std::string> cases;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kernel, name;
        if (line[0] != '#' && words >> kernel >> name) cases[kernel] = name;
    }
    return cases;
}

class Verify : public testing::TestWithParam<VerifyCase> {};

TEST_P(Verify, Holds) {
    const VerifyResult result = run_verify_case(device(), GetParam().name, {.times = false, .kernels = true});
    if (device().info().type == DeviceType::cpu) {
        for (const auto& [kernel, name] : cases_of_kernels())
            EXPECT_TRUE(name != result.name || result.kernels.contains(kernel)) << kernel << ": see kernels.txt";
    }
    EXPECT_FALSE(result.checks.empty());
    for (const VerifyCheck& check : result.checks) {
        EXPECT_TRUE(check.holds()) << check.what << ": " << check.worst << ' ' << check.unit << " of " << check.tried
                                   << ", bar " << check.bar;
        const bool lacks = !result.facts.empty() && result.facts.front().first == "the device lacks";
        EXPECT_TRUE(check.tried > 0 || lacks) << check.what;
    }
    for (const std::string& failure : result.failures) ADD_FAILURE() << failure << "\nagain: " << result.command;
}

std::string test_name(const testing::TestParamInfo<VerifyCase>& info) {
    std::string name = info.param.name;
    for (char& c : name)
        if (c == '-') c = '_';
    return name;
}
INSTANTIATE_TEST_SUITE_P(Cases, Verify, testing::ValuesIn(verify_cases()), test_name);

/// The guarantees of docs/numerics.md if hits are decided in float32.
TEST(VerifyCases, NothingLeaksWithoutDoublePrecision) {
    const std::string index = std::to_string(device().info().index);  // opened before it could lose its own
    const ScopedEnvironment without("CLARAY_NO_FP64", "1");
    const Device fresh = Device::open(index);
    EXPECT_FALSE(fresh.info().fp64);
    for (const char* name : {"edges", "vertices", "integer-edges", "fans", "closed-meshes"}) {
        const VerifyResult result = run_verify_case(fresh, name, {.times = false});
        EXPECT_TRUE(result.holds()) << name;
        for (const std::string& failure : result.failures) ADD_FAILURE() << failure;
    }
}

/// A kernel without a line in kernels.txt is run by no case: add one, and find it by `claray verify --kernels`.
TEST(VerifyCases, RunEveryKernel) {
    const auto cases = cases_of_kernels();
    for (const std::string& kernel : kernel_names()) EXPECT_TRUE(cases.contains(kernel)) << kernel;
    for (const auto& [kernel, name] : cases) {
        EXPECT_TRUE(kernel_names().contains(kernel)) << kernel;
        if (name != "-") {
            EXPECT_NO_THROW(check_verify_cases(std::vector{name})) << kernel;
        }
    }
}

TEST(VerifyCases, HaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const VerifyCase& c : verify_cases()) EXPECT_TRUE(names.insert(c.name).second) << c.name;
}

TEST(VerifyCases, UnknownNamesAreRefusedWithThoseThatExist) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "choose one of arithmetic",
                             [] { (void)run_verify_case(device(), "no-such-case"); }));
    const std::vector<std::string> names = {"sort", "no-such-case"};
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no-such-case",
                             [&] { run_verify_cases(device(), names, {}, [](const VerifyResult&) {}); }));
}

TEST(VerifyCases, AreReportedInTheOrderAskedFor) {
    const std::vector<std::string> names = {"scales", "fresnel", "sort", "integer-edges", "tree-hashes", "sort"};
    for (const unsigned threads : {0u, 1u, 3u}) {
        std::vector<VerifyResult> results;
        run_verify_cases(device(), names, {.threads = threads},
                         [&](const VerifyResult& result) { results.push_back(result); });
        ASSERT_EQ(results.size(), names.size());
        for (std::size_t i = 0; i < names.size(); ++i) {
            EXPECT_EQ(results[i].name, names[i]) << threads;
            EXPECT_FALSE(results[i].checks.empty()) << threads;
            EXPECT_TRUE(results[i].holds()) << threads;
        }
    }
}

TEST(VerifyCases, PiecesRunOnceOnDevicesOfTheirOwn) {
    for (const unsigned threads : {1u, 3u}) {
        std::vector<std::atomic<unsigned>> runs(20);
        std::mutex mutex;
        std::condition_variable one_more;
        std::map<std::thread::id, std::set<const cl::Context*>> devices;
        Devices more(device());
        side_by_side(device(), more, threads, runs.size(), [&](const Device& on, std::size_t i) {
            ++runs[i];
            std::unique_lock lock(mutex);
            devices[std::this_thread::get_id()].insert(&on.context());
            one_more.notify_all();  // to open a device may take longer than all pieces
            one_more.wait_for(lock, std::chrono::hours(1), [&] { return devices.size() == threads; });
        });
        for (const auto& count : runs) EXPECT_EQ(count, 1u);
        std::set<const cl::Context*> all;
        for (const auto& [thread, of_it] : devices) {
            EXPECT_EQ(of_it.size(), 1u);
            all.insert(*of_it.begin());
        }
        EXPECT_EQ(devices.size(), threads);
        EXPECT_EQ(all.size(), threads);
    }
}

TEST(VerifyCases, WhatAPieceThrowsArrives) {
    std::atomic<unsigned> runs = 0;
    Devices more(device());
    EXPECT_THROW(side_by_side(device(), more, 3, 20,
                              [&](const Device&, std::size_t i) {
                                  ++runs;
                                  if (i == 0) throw std::runtime_error("no more");
                              }),
                 std::runtime_error);
    EXPECT_GE(runs, 1u);
}

TEST(VerifyCases, OpenNoMoreDevicesThanAreUsedAtOnce) {
    Devices more(device());
    std::vector<Device> used;  // so that no other gets an address of theirs
    std::mutex mutex;
    std::barrier both(2);
    for (int round = 0; round < 3; ++round)
        side_by_side(device(), more, 2, 2, [&](const Device& on, std::size_t) {
            both.arrive_and_wait();
            const std::lock_guard lock(mutex);
            used.push_back(on);
        });
    std::set<const cl::Context*> contexts;
    for (const Device& on : used) contexts.insert(&on.context());
    EXPECT_EQ(used.size(), 6u);
    EXPECT_EQ(contexts.size(), 2u);
}

TEST(VerifyCases, TimesAreMediansOfManyRounds) {
    Buffer<float> values(device(), 1u << 16);
    const auto fill = [&](int times) {
        for (int i = 0; i < times; ++i) values.fill(0);
    };
    const auto ratio_of = [&](int slow_calls) {
        VerifyResult result;
        Devices more(device());
        verify::Run run(device(), more, {}, result);
        run.check_time(
            "fills", 1, [&] { fill(slow_calls-- > 0 ? 200 : 1); }, [&] { fill(1); }, 20);
        EXPECT_EQ(result.checks.size(), 1u);
        EXPECT_TRUE(result.checks[0].time);
        return result.checks[0];
    };
    EXPECT_FALSE(ratio_of(1000).holds());
    EXPECT_TRUE(ratio_of(1 + 9).holds());    // a round that does not count, and fewer than half of the others
    EXPECT_FALSE(ratio_of(1 + 12).holds());  // more than half of them
}

TEST(VerifyCases, SideBySideEndWhereTheCallerDoes) {
    const std::vector<std::string> names = {"srgb", "sort", "fresnel", "stadium", "scales"};
    unsigned reported = 0;
    EXPECT_THROW(run_verify_cases(device(), names, {.threads = 2},
                                  [&](const VerifyResult&) {
                                      ++reported;
                                      throw std::runtime_error("no more");
                                  }),
                 std::runtime_error);
    EXPECT_EQ(reported, 1u);
}

}  // namespace
}  // namespace claray::test
