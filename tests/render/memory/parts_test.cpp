// Scenes in parts: the image of one tree, by kernels/render/parts/keep_nearest.cl, in a device's memory that does not
// hold it.
#include <gtest/gtest.h>

#include <set>

#include "host/compute/device_state.hpp"
#include "host/compute/memory.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "host/render/renderer_state.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

/// Halves of the triangles as a second mesh, so that numbers are counted through several meshes.
Scene in_two_meshes(Scene scene) {
    Mesh& all = scene.meshes.at(0);
    Mesh second = all;
    const auto half = std::ptrdiff_t(all.triangles.size() / 2);
    second.triangles.erase(second.triangles.begin(), second.triangles.begin() + half);
    all.triangles.resize(std::size_t(half));
    if (!all.materials.empty()) {
        second.materials.erase(second.materials.begin(), second.materials.begin() + half);
        all.materials.resize(std::size_t(half));
    }
    scene.meshes.push_back(second);
    return scene;
}

/// Parts take turns although the device has room for all: it has as much memory as is in use and this much more.
void leave(const Device& device, std::uint64_t bytes) { state_of(device).info.memory = bytes_in_use(device) + bytes; }

/// Each triangle in nine materials at one place: which one is hit depends on the order of equal distances, also between
/// parts.
Scene in_nine_colors(Scene scene) {
    for (std::uint32_t i = 1; i < 9; ++i) {
        scene.materials.push_back(scene.materials.at(0));
        scene.materials.back().albedo = glm::vec3(0.1f * float(i), 0.5f, 0.9f);
        scene.meshes.push_back(scene.meshes[0]);
        scene.meshes.back().materials.assign(scene.meshes[0].triangles.size(),
                                             std::uint32_t(scene.materials.size()) - 1);
    }
    return scene;
}

/// The effects have cut-outs, instances in motion and lamps; the soup has many triangles at equal distances of its
/// rays.
TEST(Parts, MakeTheImageOfOneTreeBitForBit) {
    Scene doubled = in_two_meshes(*builtin_scene("soup:3000"));
    doubled.meshes.push_back(doubled.meshes[0]);
    for (const auto& [name, scene] : {std::pair("effects", *builtin_scene("effects")),
                                      {"doubled soup", doubled},
                                      {"triangles of nine colors", in_nine_colors(*builtin_scene("soup:3"))}})
        for (const Layout layout : {Layout::binary, Layout::wide}) {
            RenderConfig config{.width = 48, .height = 32, .spp = 2};
            config.bvh.layout = layout, config.parts = 1;
            const std::vector<glm::vec3> expected = render_image(scene, config);
            for (const unsigned parts : {2u, 5u}) {
                config.parts = parts;
                EXPECT_TRUE(same_bits(render_image(scene, config), expected)) << name << " in " << parts << " parts";
            }
        }
}

TEST(Parts, HaveTheAovsOfOneTree) {
    const Scene scene = *builtin_scene("soup:3000");
    RenderConfig config{.width = 40, .height = 30, .spp = 1, .parts = 1};
    const auto aovs_of = [&](unsigned parts) {
        config.parts = parts;
        return Renderer(device(), scene, config).aovs();
    };
    const Aovs one = aovs_of(1), three = aovs_of(3);
    EXPECT_EQ(one.primitive, three.primitive);
    EXPECT_EQ(one.depth, three.depth);
    EXPECT_TRUE(same_bits(one.normal, three.normal));
    std::uint64_t of_one = 0, of_three = 0;
    for (std::size_t i = 0; i < one.heat.size(); ++i) of_one += one.heat[i], of_three += three.heat[i];
    EXPECT_GT(of_three, of_one) << "tests in all parts count";
}

/// Four times what the device holds.
TEST(Parts, RenderASceneLargerThanTheDevice) {
    const Scene scene = *builtin_scene("terrain:60000");
    RenderConfig config{.width = 64, .height = 48, .spp = 2};
    const std::vector<glm::vec3> expected = render_image(scene, config);
    const Device small = Device::open(std::to_string(device().info().index));
    config.effects.add = full_effects();
    const std::uint64_t whole =
        Bvh::memory_needed(small, scene.meshes[0].positions.size(), scene.meshes[0].triangles.size(), config.bvh).bytes;
    leave(small, whole / 4);
    config.parts = 1;
    EXPECT_TRUE(throws_error(ErrorKind::device, "out of device memory: a tree of",
                             [&] { (void)Renderer(small, scene, config); }));
    config.parts = 0;
    Renderer renderer(small, scene, config);
    renderer.render();
    EXPECT_TRUE(same_bits(renderer.image(), expected));
    const RenderStatistics statistics = renderer.statistics();
    EXPECT_GE(statistics.parts, 4u);
    EXPECT_GT(statistics.bvh.bytes, small.info().memory) << "the trees alone are larger than the memory";
    EXPECT_GT(statistics.bytes_paged, 2 * statistics.bvh.bytes) << "parts took turns";
}

TEST(Parts, AreRefusedWhereVerticesDoNotFit) {
    const Scene scene = *builtin_scene("terrain:60000");
    const Device small = Device::open(std::to_string(device().info().index));
    leave(small, scene.meshes[0].positions.size() * sizeof(glm::vec3));
    EXPECT_TRUE(throws_error(ErrorKind::device, "vertices, materials and textures need about",
                             [&] { (void)Renderer(small, scene, {.width = 8, .height = 8, .spp = 1}); }));
}

TEST(Parts, HoldEveryTriangleOnce) {
    const Scene scene = in_two_meshes(*builtin_scene("soup:1001"));
    const std::vector<SceneObject> objects = objects_of(scene, 0);
    ASSERT_EQ(objects.size(), 1u);
    for (const unsigned parts : {1u, 2u, 3u, 7u, 2000u}) {
        const auto split = split_scene(scene, objects, parts);
        EXPECT_EQ(split.size(), std::min(parts, 1001u));
        std::multiset<std::uint32_t> seen;
        for (const auto& pieces : split) {
            ASSERT_EQ(pieces.size(), 1u);
            EXPECT_LE(pieces[0].triangles.size(), (1001 + parts - 1) / parts);
            EXPECT_TRUE(std::is_sorted(pieces[0].triangles.begin(), pieces[0].triangles.end()));
            seen.insert(pieces[0].triangles.begin(), pieces[0].triangles.end());
        }
        EXPECT_EQ(seen.size(), 1001u);
        EXPECT_EQ(std::set<std::uint32_t>(seen.begin(), seen.end()).size(), 1001u);
    }
}

TEST(Parts, FollowTheScene) {
    Scene scene = *builtin_scene("soup:300");
    RenderConfig config{.width = 24, .height = 16, .spp = 1, .parts = 3};
    config.effects.add = full_effects();
    Renderer renderer(device(), scene, config);
    renderer.render();
    for (glm::vec3& p : scene.meshes[0].positions) p.x *= 0.5f;
    SceneChanges changes;
    changes.vertices = true;
    renderer.update(scene, changes);
    renderer.render();
    EXPECT_TRUE(same_bits(renderer.image(), render_image(scene, config)));
}

}  // namespace
}  // namespace claray::test
