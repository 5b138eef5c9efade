// The clustering builder: bvh/hploc.cl.
#include <gtest/gtest.h>

#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

Bvh cluster(const Mesh& mesh, unsigned bits = 63) { return build(mesh, bits, Layout::binary, Builder::balanced); }

TEST(Clustering, IsValidAtEverySize) {
    for (const unsigned bits : {30u, 63u})
        for (const std::size_t count : {0u, 1u, 2u, 3u, 15u, 16u, 17u, 31u, 32u, 33u, 34u, 257u, 1000u, 5003u}) {
            const Mesh mesh = soup(count, 0.05f, count);
            const Bvh bvh = cluster(mesh, bits);
            SCOPED_TRACE(testing::Message() << count << " triangles, " << bits << " bits");
            expect_valid(bvh);
            EXPECT_EQ(state_of(bvh).read_header().valid, count);
            expect_bounds(bvh, mesh);
        }
}

/// Large among small, as walls among ornaments: the case that Morton codes, blind to size, do badly.
TEST(Clustering, GivesBetterTrees) {
    Mesh mesh = soup(20'000, 0.005f, 6);
    const Mesh walls = soup(1000, 0.7f, 7);
    const auto base = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), walls.positions.begin(), walls.positions.end());
    for (const glm::uvec3 t : walls.triangles) mesh.triangles.push_back(t + base);
    EXPECT_LT(cluster(mesh).statistics().sah_cost, 0.7 * build(mesh).statistics().sah_cost);
}

TEST(Clustering, EqualTrianglesGiveALowTree) {
    Mesh mesh = soup(1, 0.5f, 1);
    for (const auto& [count, height] : {std::pair(24u, 6u), std::pair(10'000u, 20u)}) {
        mesh.triangles.assign(count, glm::uvec3(0, 1, 2));
        const Bvh bvh = cluster(mesh);
        expect_valid(bvh);
        EXPECT_LE(state_of(bvh).read_header().height, height);
    }
}

TEST(Clustering, GivesWayToTheFastTreeWhereItWouldBeTooHigh) {
    const Bvh bvh = cluster(doubling_triangles());
    expect_valid(bvh);
    EXPECT_LE(state_of(bvh).read_header().height, unsigned(CLARAY_MAX_HEIGHT));
}

}  // namespace
}  // namespace claray::test
