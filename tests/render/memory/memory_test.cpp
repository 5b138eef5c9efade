// What a renderer tells of its memory is what its buffers take.
#include <gtest/gtest.h>

#include "claray/renderer.hpp"
#include "host/compute/memory.hpp"
#include "host/render/structure.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// A device with an account of its own.
Device own_device() { return Device::open(std::to_string(device().info().index)); }

void expect_told(const Device& on, std::uint64_t before, const Renderer& renderer, const std::string& what) {
    const RenderStatistics statistics = renderer.statistics();
    const auto taken = double(bytes_in_use(on) - before);
    EXPECT_NEAR(double(statistics.device_bytes), taken, 0.01 * taken) << what;
    EXPECT_EQ(statistics.most_device_bytes, most_bytes_in_use(on)) << what;
}

Scene instanced_terrain() {
    Scene scene = *builtin_scene("terrain:5000");
    scene.instances = {{0}, {1}, {1}};
    scene.instances[2].transform[3].y = 3.f;
    return scene;
}

TEST(RendererMemory, ToldIsTaken) {
    const Device on = own_device();
    const auto render = [&](const char* name, Builder builder) {
        const std::uint64_t before = bytes_in_use(on);
        Renderer renderer(on, *builtin_scene(name), {.width = 32, .height = 24, .spp = 2, .bvh = {.builder = builder}});
        renderer.render();
        expect_told(on, before, renderer, std::string(name) + " by " + traits_of(builder).name);
    };
    for (const BuilderTraits& traits : builders) render("terrain:20000", traits.builder);
    for (const char* name : {"cornell", "crate", "curves:3000"}) render(name, Builder::automatic);
}

TEST(RendererMemory, ToldIsTakenOfStructuresBuiltByTheHost) {
    const Device on = own_device();
    for (const Scene& scene : {instanced_terrain(), *builtin_scene("terrain:20000")}) {
        const std::uint64_t before = bytes_in_use(on);
        const Structure structure(on, scene, 0, {.layout = Layout::binary}, true);
        const auto taken = double(bytes_in_use(on) - before);
        EXPECT_NEAR(double(structure.bytes()), taken, 0.01 * taken);
    }
}

TEST(RendererMemory, ToldIsTakenOfPartsAndInstances) {
    const Device on = own_device();
    for (const Scene& scene : {instanced_terrain(), *builtin_scene("terrain:20000")})
        for (const unsigned parts : {1u, 3u}) {
            const std::uint64_t before = bytes_in_use(on);
            Renderer renderer(on, scene, {.width = 32, .height = 24, .spp = 2, .parts = parts});
            renderer.render();
            expect_told(on, before, renderer, std::to_string(parts) + " parts");
        }
}

TEST(RendererMemory, ToldIsTakenOfWhatIsAskedForLater) {
    const Device on = own_device();
    const std::uint64_t before = bytes_in_use(on);
    Renderer renderer(on, *builtin_scene("cornell"),
                      {.width = 64, .height = 48, .spp = 8, .error = 0.5, .adaptive = true});
    renderer.render();
    (void)renderer.image();
    expect_told(on, before, renderer, "the image");
    (void)renderer.picture();
    expect_told(on, before, renderer, "the picture");
    (void)renderer.aovs();
    expect_told(on, before, renderer, "AOVs");
    (void)renderer.denoised();
    expect_told(on, before, renderer, "the denoised image");
}

}  // namespace
}  // namespace claray::test
