// The tree that the host builds for a first picture: build_by_host.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/host_tree.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

Bvh by_host(std::span<const Mesh> meshes) { return build_by_host(device(), meshes, {}); }

TEST(HostTree, IsValidAndLowAtEverySize) {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 5u, 64u, 257u, 5003u}) {
        const Mesh mesh = soup(count, 0.05f, count);
        const Bvh bvh = by_host(std::span(&mesh, 1));
        SCOPED_TRACE(count);
        expect_valid(bvh);
        const BvhHeader header = state_of(bvh).read_header();
        EXPECT_EQ(bvh.layout(), Layout::binary);
        EXPECT_EQ(header.valid, count);
        EXPECT_EQ(header.height, count < 2 ? 0u : std::bit_width(count - 1));
        if (count == 0) {
            EXPECT_EQ(header.root, CLARAY_NO_CHILD);
            EXPECT_GT(header.lox, header.hix);
        }
        expect_bounds(bvh, mesh);
    }
}

TEST(HostTree, EqualTrianglesMakeItNoHigher) {
    Mesh mesh = soup(1, 0.5f, 1);
    mesh.triangles.assign(1000, glm::uvec3(0, 1, 2));
    const Bvh bvh = by_host(std::span(&mesh, 1));
    expect_valid(bvh);
    EXPECT_EQ(state_of(bvh).read_header().height, 10u);
}

TEST(HostTree, LeavesOutWhatTheDeviceLeavesOut) {
    std::vector<Mesh> meshes = {soup(300, 0.05f, 3), soup(200, 0.05f, 4)};
    std::vector<glm::vec3>& p = meshes[1].positions;
    const float bad[] = {nan, infinity, -infinity, 1.1e18f, std::nextafter(1e18f, infinity)};
    for (int i = 0; i < 5; ++i) p[meshes[1].triangles[10 * i][i % 3]][i % 3] = bad[i];
    p[meshes[1].triangles[60].x] = p[meshes[1].triangles[60].y];
    p[meshes[1].triangles[70].y] = p[meshes[1].triangles[70].z];
    p[meshes[1].triangles[80].z] = p[meshes[1].triangles[80].x];
    p[meshes[1].triangles[90].x].x = 1e18f;  // the largest that counts
    meshes[1].mask = 5;
    const Bvh host = by_host(meshes), other = Bvh::build(device(), meshes, {.layout = Layout::binary});
    expect_valid(host);
    EXPECT_EQ(state_of(host).read_header().culled, 8u);
    EXPECT_EQ(state_of(other).read_header().culled, 8u);
    // All that leaves hold, in the order of the input.
    const auto sorted = [](const Bvh& bvh) {
        std::vector<LeafTriangle> leaves(state_of(bvh).read_header().valid);
        state_of(bvh).leaves.read(std::span(leaves));
        std::sort(leaves.begin(), leaves.end(), [](auto& a, auto& b) { return a.primitive < b.primitive; });
        return leaves;
    };
    const std::vector<LeafTriangle> a = sorted(host), b = sorted(other);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

TEST(HostTree, CanBeRefittedAndRebuilt) {
    const Mesh mesh = soup(5003, 0.05f, 5), moved = soup(5003, 0.05f, 6);
    Bvh bvh = by_host(std::span(&mesh, 1));
    std::vector<float> positions;
    for (const glm::vec3& p : moved.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
    Buffer<float> on_device = bvh.triangles().positions;
    on_device.write(positions);
    bvh.refit();
    expect_valid(bvh);
    bvh.rebuild();
    expect_valid(bvh);
    EXPECT_EQ(bvh.hash(), build(moved).hash());
}

}  // namespace
}  // namespace claray::test
