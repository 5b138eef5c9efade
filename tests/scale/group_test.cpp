// Several devices share an image.
#include <gtest/gtest.h>

#include "claray/scale/render_group.hpp"
#include "host/compute/memory.hpp"
#include "host/scale/group_state.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

/// Queues and contexts of their own, on the test's device.
std::vector<Device> several(unsigned count) {
    std::vector<Device> devices;
    for (unsigned i = 0; i < count; ++i) devices.push_back(Device::open(std::to_string(device().info().index)));
    return devices;
}

bool same(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

/// A device that starts late, on a busy machine, would find nothing left to do.
void wait_for_all(RenderGroup& group) {
    RenderGroup::State& state = state_of(group);
    const auto starts = [](const RenderGroup::State::Member& member) { return !member.is_ready && !member.has_failed; };
    while (std::any_of(state.members.begin(), state.members.end(), starts))
        state.take_report(std::chrono::milliseconds(20));
}

class Groups : public testing::Test {
protected:
    [[nodiscard]] std::vector<glm::vec3> of_one(const RenderConfig& config) const {
        Renderer renderer(device(), scene_, config);
        reached_ = renderer.render();
        return renderer.image();
    }
    [[nodiscard]] std::vector<glm::vec3> of_several(unsigned count, const RenderConfig& config) const {
        RenderGroup group(several(count), scene_, config);
        reached_ = group.render();
        return group.renderer().image();
    }
    /// The same, where no device starts late nor is left out of a short render.
    [[nodiscard]] std::vector<glm::vec3> of_all(unsigned count, const RenderConfig& config) const {
        RenderGroup group(several(count), scene_, config);
        wait_for_all(group);
        for (RenderGroup::State::Member& member : state_of(group).members) member.handover = 0;
        reached_ = group.render();
        for (const DeviceShare& share : group.shares()) EXPECT_GT(share.samples, 0u) << "all take part";
        return group.renderer().image();
    }

    TemporaryFolder folder_;
    Scene scene_ = *builtin_scene("cornell");
    RenderConfig config_{.width = 61, .height = 43, .spp = 37};
    mutable RenderProgress reached_;
};

TEST_F(Groups, MakeTheImageOfOneDeviceBitForBit) {
    const std::vector<glm::vec3> expected = of_one(config_);
    for (const unsigned count : {1u, 2u, 3u}) {
        EXPECT_TRUE(same(of_all(count, config_), expected)) << count << " devices";
        EXPECT_EQ(reached_.spp, config_.spp);
    }
    const RenderConfig large{.width = 640, .height = 480, .spp = 4};  // whose sums are copied in pieces
    EXPECT_TRUE(same(of_all(2, large), of_one(large)));
}

TEST_F(Groups, TakeADeviceThatIsListedTwice) {
    const std::vector<glm::vec3> expected = of_one(config_);
    for (int run = 0; run < 5; ++run) {
        const Device own = Device::open(std::to_string(device().info().index));
        RenderGroup group({own, own, own}, scene_, config_);
        wait_for_all(group);
        group.render();
        for (const DeviceShare& share : group.shares()) EXPECT_EQ(share.failure, "");
        EXPECT_TRUE(same(group.renderer().image(), expected));
    }
}

TEST_F(Groups, ShareScenesOfPrimitives) {
    scene_ = *builtin_scene("curves:500");
    config_.spp = 9;
    EXPECT_TRUE(same(of_all(2, config_), of_one(config_)));
}

TEST_F(Groups, StopAtTheSameErrorAndNoise) {
    config_.spp = 4096;
    for (const auto& [error, noise] : {std::pair(0.2, 0.), {0., 0.1}}) {
        config_.error = error, config_.noise = noise;
        const std::vector<glm::vec3> expected = of_one(config_);
        const RenderProgress one = reached_;
        EXPECT_LT(one.spp, 4096u);
        EXPECT_TRUE(same(of_all(2, config_), expected)) << "error " << error << ", noise " << noise;
        EXPECT_EQ(reached_.spp, one.spp);
        EXPECT_EQ(reached_.error_bound, one.error_bound);
        EXPECT_EQ(reached_.noise, one.noise);
    }
}

/// After an interruption one device and several continue with the same bits.
TEST_F(Groups, ContinueFromCheckpoints) {
    config_.spp = 200;  // more than the orders on the way when it is interrupted
    const std::vector<glm::vec3> expected = of_one(config_);
    config_.checkpoint = folder_ / "c", config_.report_seconds = 0;
    RenderConfig resumed = config_;
    resumed.resume = resumed.checkpoint;
    for (const unsigned spp : {0, 20}) {
        const auto goes_on = [&](const RenderProgress& progress) { return progress.spp < spp; };
        for (const bool one_goes_on : {false, true}) {
            {
                RenderGroup group(several(2), scene_, config_);
                group.render(goes_on);
                EXPECT_EQ(group.checkpoint_error(), "");
                EXPECT_FALSE(same(group.renderer().image(), expected));
            }
            EXPECT_TRUE(same(one_goes_on ? of_one(resumed) : of_several(3, resumed), expected)) << spp;
            EXPECT_TRUE(same(of_several(2, resumed), expected)) << "what is complete stays so";
        }
        Renderer one(device(), scene_, config_);
        one.render(goes_on);
        EXPECT_TRUE(same(of_several(2, resumed), expected)) << "begun by one";
    }
}

/// Each device learns by itself where light comes from.
TEST_F(Groups, GuidePathsAsOneDevice) {
    if (device().info().type != DeviceType::cpu) GTEST_SKIP() << "paths are guided on CPUs only";
    config_.width = config_.height = 160, config_.spp = 40;
    config_.guide = false;
    const std::vector<glm::vec3> without = of_one(config_);
    config_.guide = true;
    const std::vector<glm::vec3> expected = of_one(config_);
    EXPECT_FALSE(same(expected, without)) << "nothing is guided";
    EXPECT_TRUE(same(of_all(2, config_), expected));
    config_.checkpoint = folder_ / "c", config_.report_seconds = 0;
    RenderGroup(several(2), scene_, config_).render([](const RenderProgress& at) { return at.spp < 12; });
    config_.resume = config_.checkpoint;
    EXPECT_TRUE(same(of_one(config_), expected));
}

TEST_F(Groups, DropADeviceThatFails) {
    config_.spp = 150;
    const std::vector<glm::vec3> expected = of_one(config_);
    for (const std::size_t failing : {0u, 1u})
        for (const unsigned nth : {1u, 20u, 50u}) {
            const std::vector<Device> devices = several(2);
            fail_command(devices[failing], nth);
            std::vector<std::string> told;
            RenderConfig config = config_;
            config.checkpoint = folder_ / "c", config.checkpoint_seconds = 0.01;  // sums are handed over periodically
            RenderGroup group(devices, scene_, config, [&](const std::string& line) { told.push_back(line); });
            wait_for_all(group);
            group.render();
            EXPECT_TRUE(same(group.renderer().image(), expected)) << failing << " fails at command " << nth;
            ASSERT_EQ(told.size(), 1u);
            EXPECT_NE(told[0].find("is dropped and the others go on: cannot run the kernel"), std::string::npos)
                << told[0];
            EXPECT_FALSE(group.shares()[failing].failure.empty());
        }
}

TEST_F(Groups, ThatFailAltogetherLeaveACheckpoint) {
    const std::vector<glm::vec3> expected = of_one(config_);
    config_.checkpoint = folder_ / "c", config_.checkpoint_seconds = 1e-9;
    {
        const std::vector<Device> devices = several(2);
        fail_command(devices[0], 70), fail_command(devices[1], 70);
        RenderGroup group(devices, scene_, config_);
        EXPECT_TRUE(throws_error(ErrorKind::device, "cannot run the kernel", [&] { group.render(); }));
    }
    config_.resume = config_.checkpoint;
    EXPECT_TRUE(same(of_several(2, config_), expected));
}

TEST_F(Groups, EndInTime) {
    config_.spp = 1u << 20, config_.seconds = 0.4;
    RenderGroup group(several(2), scene_, config_);
    wait_for_all(group);
    for (RenderGroup::State::Member& member : state_of(group).members) member.handover = 0;
    reached_ = group.render();
    for (const DeviceShare& share : group.shares()) EXPECT_GT(share.samples, 0u) << "both take part";
    EXPECT_GE(reached_.spp, 1u);
    EXPECT_LT(reached_.spp, 1u << 20);
    config_.seconds = 1e-9;
    (void)of_several(2, config_);
    EXPECT_GE(reached_.spp, 1u) << "every pixel has a sample";
}

TEST_F(Groups, RefuseWhatTheyCannotShare) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "at least one device", [&] { RenderGroup({}, scene_, config_); }));
    config_.adaptive = true;
    EXPECT_TRUE(throws_error(ErrorKind::usage, "adaptive sampling", [&] { RenderGroup(several(2), scene_, config_); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "twice", [] { (void)Device::open_several("0,0"); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "not a list", [] { (void)Device::open_several("0,,0"); }));
    EXPECT_FALSE(Device::open_several("all").empty());
}

}  // namespace
}  // namespace claray::test
