// Failures in the middle: each allocation and each kernel of each kind of work fails in turn. Every time there is a
// clear error, nothing leaks, and what comes next works.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "claray/instances.hpp"
#include "claray/query.hpp"
#include "claray/renderer.hpp"
#include "host/compute/memory.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

class Failures : public testing::Test {
protected:
    using Injection = void (*)(const Device&, unsigned);

    /// Lets the nth of them fail for n = 1, 1 + step, 1 + 2 step ... until the work is done without.
    void each_in_turn(Injection inject, const std::string& words, const std::function<void()>& work, unsigned least,
                      unsigned step) {
        work();
        device_.finish();
        const std::uint64_t before = bytes_in_use(device_);
        unsigned n = 1, failed = 0;
        for (bool done = false; !done; n += step) {
            inject(device_, n);
            try {
                work();
                done = true;
            } catch (const Error& error) {
                const std::string text = error.what();
                EXPECT_EQ(error.kind(), ErrorKind::device) << text;
                EXPECT_NE(text.find(words), std::string::npos) << text;
                EXPECT_NE(text.find(device_.info().name), std::string::npos) << text;
                ++failed;
            }
            inject(device_, 0);
            device_.finish();
            ASSERT_EQ(bytes_in_use(device_), before) << "after failure " << n;
        }
        EXPECT_NO_THROW(work());
        EXPECT_GE(failed, least);
        RecordProperty("failures", int(failed));
        std::printf("%u failures injected\n", failed);
    }
    void allocations(const std::function<void()>& work, unsigned least, unsigned step = 1) {
        each_in_turn(fail_allocation, "out of device memory", work, least, step);
    }
    void commands(const std::function<void()>& work, unsigned least, unsigned step = 1) {
        each_in_turn(fail_command, "cannot run the kernel ", work, least, step);
    }

    Mesh mesh_ = soup(700, 0.1f, 4);
    Device device_ = Device::open(std::to_string(device().info().index));  // its failures are its own
};

std::vector<Bvh::Config> all_configs() {
    std::vector<Bvh::Config> configs;
    for (const Builder builder : {Builder::fast, Builder::balanced, Builder::high})
        for (const Layout layout : {Layout::binary, Layout::wide})
            configs.push_back({.builder = builder, .layout = layout});
    return configs;
}

TEST_F(Failures, OfBuilds) {
    for (const Bvh::Config& config : all_configs()) {
        const auto build = [&] { (void)Bvh::build(device_, std::span(&mesh_, 1), config); };
        allocations(build, 8);
        commands(build, 5);
    }
}

TEST_F(Failures, OfInstances) {
    const auto build = [&] {
        const Bvh bvh = Bvh::build(device_, std::span(&mesh_, 1));
        Instance instance{};
        instance.row0[0] = instance.row1[1] = instance.row2[2] = 1, instance.mask = ~0u;
        const std::vector<Instance> instances(3, instance);
        (void)InstancedBvh::build(std::span(&bvh, 1), std::span<const Instance>(instances));
    };
    allocations(build, 12);
}

TEST_F(Failures, OfQueries) {
    std::vector<Ray> rays(70'000);  // enough to be sorted on CPUs
    for (std::size_t i = 0; i < rays.size(); ++i)
        rays[i] = {float(i % 97) / 97,      float(i % 89) / 89,        -1, 0,
                   float(i % 7) / 7 - 0.5f, float(i % 11) / 11 - 0.5f, 1,  9};
    const Bvh bvh = Bvh::build(device_, std::span(&mesh_, 1));
    const std::vector<Hit> expected = closest_hit(bvh, rays);
    const auto of_host = [&] {
        const std::vector<Hit> hits = closest_hit(bvh, rays);
        ASSERT_EQ(std::memcmp(hits.data(), expected.data(), hits.size() * sizeof(Hit)), 0);
        (void)any_hit(bvh, rays);
    };
    allocations(of_host, device_.info().type == DeviceType::cpu ? 0 : 4);  // CPUs use the host's memory in place
    commands(of_host, 2);
    const auto of_device = [&] {
        const Buffer<Ray> first(device_, rays), second(device_, rays);
        Buffer<Hit> hits(device_, rays.size());
        Buffer<std::uint8_t> occluded(device_, rays.size());
        closest_hit(bvh, first, hits);
        any_hit(bvh, second, occluded);
        const std::vector<Hit> found = hits.read();
        ASSERT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(Hit)), 0);
    };
    allocations(of_device, 4);
    commands(of_device, 2);
}

TEST_F(Failures, OfRenders) {
    for (const auto& [name, step] :
         {std::pair("cornell", 1u), {"effects", 9u}}) {  // the latter needs a while each time
        const Scene scene = *builtin_scene(name);
        const auto render = [&] {
            Renderer renderer(device_, scene, {.width = 16, .height = 9, .spp = 2, .max_depth = 3});
            renderer.render();
            (void)renderer.image();
            (void)renderer.aovs();
            (void)renderer.cut_off();
        };
        allocations(render, 40 / step, step);
        commands(render, 40 / step, step);
    }
}

TEST_F(Failures, OfBaking) {
    Scene scene;
    scene.materials = {lambert(0.5f), emitter(1.f)};
    scene.meshes = {square(1.f, 0.f), square(1.f, 1.f, 1)};
    scene.meshes[0].uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const LightMapConfig config{.width = 4, .height = 4, .spp = 2, .uv_set = 0};
    const auto bake = [&] { (void)bake_light_map(device_, scene, 0, config); };
    allocations(bake, 20);
    commands(bake, 10);
}

/// The device is lost while an image is rendered: the report says on what, and the last checkpoint is good.
TEST_F(Failures, LostDeviceLeavesACheckpoint) {
    const TemporaryFolder folder;
    const Scene scene = *builtin_scene("cornell");
    RenderConfig config{.width = 24, .height = 16, .spp = 40, .checkpoint = folder / "c", .checkpoint_seconds = 1e-9};
    const std::vector<glm::vec3> whole = render_image(scene, {.width = 24, .height = 16, .spp = 40});
    Renderer renderer(device_, scene, config);
    fail_command(device_, 60);
    std::string report;
    try {
        renderer.render();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::device);
        report = error.what();
    }
    for (const char* words : {"cannot run the kernel ", "gave -5\n", "device: ", "driver: ", "kernel sources: ",
                              "compiled from and with: ", ".cl -cl-std=CL1.2 "})
        EXPECT_NE(report.find(words), std::string::npos) << words << " in " << report;
    config.resume = config.checkpoint;
    const std::vector<glm::vec3> resumed = render_image(scene, config);
    EXPECT_EQ(std::memcmp(resumed.data(), whole.data(), whole.size() * sizeof whole[0]), 0);
}

}  // namespace
}  // namespace claray::test
