// Refit: bvh/refit.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "claray/query.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

std::vector<float> flat(const Mesh& mesh) {
    std::vector<float> values;
    for (const glm::vec3& p : mesh.positions) values.insert(values.end(), {p.x, p.y, p.z});
    return values;
}

Mesh moved(Mesh mesh) {
    for (glm::vec3& p : mesh.positions) p = glm::vec3(p.y, -p.x, p.z) + 0.3f * glm::sin(5.f * p);
    return mesh;
}

class RefitTest : public testing::TestWithParam<Layout> {};

/// Boxes of trees with spatial splits grow, since refits know whole triangles only.
TEST_P(RefitTest, ChangesNothingWhereNothingMoved) {
    const std::vector<Mesh> meshes = {soup(3001, 0.05f, 1)};
    Bvh bvh = Bvh::build(device(), meshes, {.builder = Builder::balanced, .layout = GetParam()});
    const std::string hash = bvh.hash();
    bvh.refit();
    EXPECT_EQ(bvh.hash(), hash);
}

TEST_P(RefitTest, HitsEqualTheOracleAfterMotion) {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 2003u}) {
        const Mesh before = soup(count, 0.2f, count), after = moved(before);
        Bvh bvh = Bvh::build(device(), std::span(&before, 1), {.layout = GetParam()});
        Buffer<float> positions = bvh.triangles().positions;
        positions.write(flat(after));
        bvh.refit();
        EXPECT_TRUE(bvh.validate().ok()) << count;
        const std::vector<Ray> rays = random_rays(5003, 4.f, 1.f, 2);
        const HitComparison result = compare(closest_hit(bvh, rays), Oracle(std::span(&after, 1)).closest_hits(rays));
        EXPECT_EQ(result.wrong, 0u) << count;
    }
}

/// Groups join subtrees in local memory; groups of one item climb through global memory only.
TEST_P(RefitTest, GroupsOfAllSizesGiveTheSameBoxes) {
    const auto with_groups = [](unsigned size) {
        Device opened = Device::open(std::to_string(device().info().index));
        opened.set_tuning("bvh/refit", "GROUP_SIZE", size);
        return opened;
    };
    const Device climbing = with_groups(1), small = with_groups(32), large = with_groups(256);
    for (const Builder builder : {Builder::fast, Builder::balanced, Builder::high})
        for (const std::size_t count : {1u, 2u, 3u, 40u, 2003u}) {
            const Mesh before = soup(count, 0.2f, count), after = moved(before);
            std::vector<std::string> hashes;
            for (const Device& on : {climbing, small, large}) {
                Bvh bvh = Bvh::build(on, std::span(&before, 1), {.builder = builder, .layout = GetParam()});
                Buffer<float> positions = bvh.triangles().positions;
                positions.write(flat(after));
                for (int i = 0; i < 2; ++i) bvh.refit();
                EXPECT_TRUE(bvh.validate().ok()) << count;
                hashes.push_back(bvh.hash());
            }
            EXPECT_EQ(hashes[1], hashes[0]) << count;
            EXPECT_EQ(hashes[2], hashes[0]) << count;
        }
}

TEST_P(RefitTest, RebuildEqualsAFreshBuild) {
    const Mesh before = soup(2003, 0.1f, 3), after = moved(before);
    Bvh bvh = Bvh::build(device(), std::span(&before, 1), {.layout = GetParam()});
    Buffer<float> positions = bvh.triangles().positions;
    positions.write(flat(after));
    bvh.rebuild();
    EXPECT_EQ(bvh.hash(), Bvh::build(device(), std::span(&after, 1), {.layout = GetParam()}).hash());
}

TEST_P(RefitTest, TrianglesThatBecomeNanVanish) {
    Mesh mesh = soup(100, 0.3f, 4);
    Bvh bvh = Bvh::build(device(), std::span(&mesh, 1), {.layout = GetParam()});
    for (std::size_t i = 0; i < 30; ++i) mesh.positions[3 * i].y = std::numeric_limits<float>::quiet_NaN();
    Buffer<float> positions = bvh.triangles().positions;
    positions.write(flat(mesh));
    bvh.refit();
    const std::vector<Ray> rays = random_rays(5003, 4.f, 1.f, 5);
    const HitComparison result = compare(closest_hit(bvh, rays), Oracle(std::span(&mesh, 1)).closest_hits(rays));
    EXPECT_GT(result.hits, 0u);
    EXPECT_EQ(result.wrong, 0u);
}

/// A twist that grows: neighbours in the tree drift apart.
TEST_P(RefitTest, TellsWhenToRebuild) {
    const Mesh still = sphere(4);
    for (const Builder builder : {Builder::fast, Builder::balanced, Builder::high}) {
        Bvh bvh =
            Bvh::build(device(), std::span(&still, 1), {.builder = builder, .layout = GetParam(), .split_budget = 0});
        Buffer<float> positions = bvh.triangles().positions;
        EXPECT_EQ(bvh.cost_growth(), 1.0);
        double before = 1;
        for (const float turns : {0.f, 0.25f, 0.5f, 1.f, 2.f}) {
            Mesh twisted = still;
            for (glm::vec3& p : twisted.positions) {
                const float angle = 6.2831853f * turns * p.z;
                p = {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y, p.z};
            }
            positions.write(flat(twisted));
            bvh.refit();
            EXPECT_GE(bvh.cost_growth(), before * 0.999);
            before = bvh.cost_growth();
            if (turns == 0.f) {
                EXPECT_FALSE(should_rebuild(bvh));
            }
        }
        EXPECT_GT(before, 2.0);
        EXPECT_TRUE(should_rebuild(bvh));
        EXPECT_FALSE(should_rebuild(bvh, 1.01 * before));
        bvh.rebuild();
        EXPECT_EQ(bvh.cost_growth(), 1.0);
        bvh.refit();
        EXPECT_FALSE(should_rebuild(bvh));
    }
}

INSTANTIATE_TEST_SUITE_P(Layouts, RefitTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

}  // namespace
}  // namespace claray::test
