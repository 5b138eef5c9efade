// What ranks send each other arrives unchanged.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host/ranks/protocol.hpp"
#include "host/render/checkpoint/checkpoint.hpp"
#include "host/render/checkpoint/scene_digest.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

using namespace ranks;

RenderConfig unusual_config() {
    RenderConfig config{.width = 61, .height = 43, .spp = 21, .max_depth = 7, .seed = 5};
    config.noise = 0.5, config.error = 0.25, config.report_seconds = 3;
    config.sampler = Sampler::independent;
    config.bvh = {.builder = Builder::high, .split_budget = 0.25};
    config.effects = parse_effect_overrides("+textures,-mirror");
    config.approximate.flat = true, config.light_grid.side = 20;
    config.compiler = "claray", config.checkpoint = "c", config.resume = "d";
    return config;
}

TEST(Protocol, BringsScenesAndSettings) {
    for (const char* name : {"effects", "cornell", "hair:100"}) {
        const Scene scene = *builtin_scene(name);
        const RenderConfig config = unusual_config();
        const RenderTask task = task_from(to_bytes(7, config, scene));
        EXPECT_EQ(task.number, 7u);
        EXPECT_EQ(digest_of(task.scene), digest_of(scene)) << name;
        EXPECT_EQ(task.scene.name, scene.name);
        EXPECT_EQ(task.scene.materials[0].name, scene.materials[0].name);
        const RenderIdentity sent = identity_of(scene, config), come = identity_of(task.scene, task.config);
        EXPECT_EQ(come.settings, sent.settings);
        EXPECT_EQ(come.width, sent.width);
        EXPECT_EQ(task.config.spp, config.spp);
        EXPECT_EQ(task.config.noise, config.noise);
        EXPECT_EQ(task.config.bvh.builder, config.bvh.builder);
        EXPECT_EQ(task.config.compiler, "") << "it belongs to a machine";
        EXPECT_TRUE(task.config.checkpoint.empty() && task.config.resume.empty());
    }
}

TEST(Protocol, BringsOrdersAndReports) {
    RemoteOrder order{3, 1, {Order::Kind::give, {10, 2, 4, 8, 0}, true}, {}};
    order.sums.resize(2), order.sums[1].all.g = 0.5f;
    const RemoteOrder come = order_from(to_bytes(order));
    EXPECT_EQ(come.task, 3u);
    EXPECT_EQ(come.device, 1u);
    EXPECT_EQ(come.order.kind, Order::Kind::give);
    EXPECT_EQ(come.order.batch.first_sample, 4u);
    EXPECT_EQ(come.sums.at(1).all.g, 0.5f);

    const RenderedFrame frame =
        rendered_from(to_bytes(RenderedFrame{5, {"a"}, {std::string("b\0c", 3)}, {{1, 2, 3}}, {2, "why"}}));
    EXPECT_EQ(frame.frame, 5u);
    EXPECT_EQ(frame.names.at(0), "a");
    EXPECT_EQ(frame.files.at(0), std::string("b\0c", 3));
    EXPECT_EQ(frame.pixels.at(0), glm::vec3(1, 2, 3));
    EXPECT_EQ(frame.failure.exit_code, 2);
    EXPECT_EQ(frame.failure.text, "why");

    RemoteReport report{4, {2, Report::Kind::failed}};
    report.report.error = ErrorKind::user, report.report.what = "why";
    const RemoteReport told = report_from(to_bytes(report));
    EXPECT_EQ(told.task, 4u);
    EXPECT_EQ(told.report.worker, 2u);
    EXPECT_EQ(told.report.kind, Report::Kind::failed);
    EXPECT_EQ(told.report.error, ErrorKind::user);
    EXPECT_EQ(told.report.what, "why");
}

TEST(Protocol, SeesDamage) {
    for (const std::string& bytes : {std::string(), std::string("a"), std::string(1000, '\0')}) {
        const std::string sent = sealed(bytes);
        EXPECT_EQ(unsealed(sent), bytes);
        for (std::size_t i = 0; i < sent.size(); ++i) {
            std::string flipped = sent;
            flipped[i] = char(flipped[i] ^ 1);
            EXPECT_FALSE(unsealed(flipped)) << i;
            EXPECT_FALSE(unsealed(sent.substr(0, i))) << i;
        }
        EXPECT_FALSE(unsealed(sent + "x"));
    }
}

/// What no rank of this version sends.
TEST(Protocol, RefusesWhatCannotBe) {
    const auto refused = [](const std::string& why, const std::function<void()>& read) {
        EXPECT_TRUE(throws_error(ErrorKind::user, "a message of another process " + why, read));
    };
    const Hello hello{"v", "o", "h", {"a"}};
    refused("is too long", [&] { (void)hello_from(to_bytes(hello) + "x"); });
    refused("names no device", [&] { (void)hello_from(to_bytes(Hello{"v", "o", "h", {}})); });
    for (const int code : {0, 4, -1, 1 << 20})
        refused("has an exit code of", [&] { (void)failure_from(to_bytes(Failure{code, "why"})); });
    RemoteReport report{1, {0, Report::Kind::done}};
    for (const double seconds : {-1.0, double(NAN), double(INFINITY)}) {
        report.report.seconds = seconds;
        refused("has a time of", [&] { (void)report_from(to_bytes(report)); });
    }
    report.report.seconds = 0, report.report.kind = Report::Kind(3);
    refused("has a report of no kind", [&] { (void)report_from(to_bytes(report)); });
    report.report.kind = Report::Kind::failed, report.report.error = ErrorKind(0);
    refused("has an exit code of 0", [&] { (void)report_from(to_bytes(report)); });
    refused("has an order of no kind", [&] { (void)order_from(to_bytes(RemoteOrder{1, 0, {Order::Kind(9)}, {}})); });
    for (const char* name : {"../a.png", "/a.png", "b/a.png", "..", ".", "", "b\\a.png"})
        refused("names a file of another folder", [&] {
            (void)rendered_from(to_bytes(RenderedFrame{1, {name}, {"x"}, {}, {}}));
        });
    refused("has other names than files", [&] {
        (void)rendered_from(to_bytes(RenderedFrame{1, {"a", "b"}, {"x"}, {}, {}}));
    });
}

/// A message that is cut anywhere is refused, and a wrong length allocates nothing.
TEST(Protocol, RefusesWhatEndsTooEarly) {
    const std::string whole = to_bytes(1, RenderConfig{}, *builtin_scene("cornell"));
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 50)
        EXPECT_TRUE(throws_error(ErrorKind::user, "ends too early", [&] { (void)task_from(whole.substr(0, length)); }))
            << length;
    EXPECT_TRUE(throws_error(ErrorKind::user, "ends too early", [] { (void)hello_from(std::string(8, '\xff')); }));
}

}  // namespace
}  // namespace claray::test
