// The serial schedule of the builders (bvh/centroids.cl, bvh/serial/lbvh_serial.cl, bvh/serial/hploc_serial.cl) gives
// the same trees as the climbing one, for any number of ranges.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

Device with_ranges(unsigned per_unit) {
    Device opened = Device::open(std::to_string(device().info().index));
    opened.set_tuning("bvh/serial", "RANGES_PER_UNIT", per_unit);
    opened.set_tuning("bvh/serial", "RANGE_LEAVES", 1);
    return opened;
}

struct Case {
    Builder builder;
    unsigned bits;
};
const Case cases[] = {{Builder::fast, 63}, {Builder::fast, 30}, {Builder::balanced, 63}, {Builder::balanced, 30}};

void expect_same_trees(const std::vector<Mesh>& meshes, const std::string& what) {
    static const Device climbing = with_ranges(0), few = with_ranges(1), many = with_ranges(17);
    for (const auto& [builder, bits] : cases) {
        SCOPED_TRACE(what + (builder == Builder::fast ? ", fast, " : ", balanced, ") + std::to_string(bits));
        const Bvh::Config config = {.builder = builder, .morton_bits = bits, .layout = Layout::binary};
        const Bvh wanted = Bvh::build(climbing, meshes, config);
        for (const Device& on : {few, many}) {
            Bvh bvh = Bvh::build(on, meshes, config);
            bvh.rebuild();  // numbers left over from the first build must not show
            expect_valid(bvh);
            ASSERT_EQ(bvh.hash(), wanted.hash());
            const BvhHeader got = state_of(bvh).read_header(), header = state_of(wanted).read_header();
            EXPECT_EQ(got.height, header.height);
            EXPECT_EQ(got.valid, header.valid);
            if (header.valid == 0) continue;
            EXPECT_EQ(glm::vec3(got.lox, got.loy, got.loz), glm::vec3(header.lox, header.loy, header.loz));
            EXPECT_EQ(glm::vec3(got.hix, got.hiy, got.hiz), glm::vec3(header.hix, header.hiy, header.hiz));
        }
    }
}

TEST(SerialBuild, GivesTheSameTreeAtEverySize) {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 15u, 16u, 17u, 18u, 31u, 33u, 64u, 257u, 1000u, 5003u})
        expect_same_trees({soup(count, 0.05f, count)}, std::to_string(count) + " triangles");
}

TEST(SerialBuild, GivesTheSameTreeOfEqualCodes) {
    Mesh mesh = soup(2, 0.5f, 1);
    for (const std::size_t count : {2u, 3u, 17u, 1000u}) {
        mesh.triangles.assign(count, glm::uvec3(0, 1, 2));
        expect_same_trees({mesh}, std::to_string(count) + " equal triangles");
        mesh.triangles.insert(mesh.triangles.begin(), glm::uvec3(3, 4, 5));  // first or last code
        expect_same_trees({mesh}, std::to_string(count) + " equal triangles and another");
    }
}

TEST(SerialBuild, GivesTheSameTreeOfCulledAndPlanarAndSeveralMeshes) {
    Mesh dirty = soup(700, 0.05f, 3);
    dirty.positions[30].x = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t i = 300; i < 600; ++i) dirty.triangles[i].y = dirty.triangles[i].x;
    expect_same_trees({dirty}, "culled");
    for (glm::uvec3& triangle : dirty.triangles) triangle = glm::uvec3(0);
    expect_same_trees({dirty}, "all culled");
    dirty.triangles[5] = {0, 1, 2};
    expect_same_trees({dirty}, "all but one culled");
    Mesh masked = soup(100, 0.1f, 4);
    masked.mask = 5;
    expect_same_trees({grid(20), masked, Mesh(), soup(333, 0.3f, 5)}, "several meshes");
}

/// Every border between leaves is at another level: the deepest stack that codes of 63 bits allow.
TEST(SerialBuild, GivesTheSameTreeOfTheDeepestCodes) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < 63; ++i) {
        const float at = std::ldexp(1.f, -int(i / 3)), size = at * 1e-3f;
        glm::vec3 corner(0);
        for (std::uint32_t axis = 0; axis <= i % 3; ++axis) corner[int(axis)] = at;
        for (const glm::vec3& offset : {glm::vec3(0), glm::vec3(size, 0, 0), glm::vec3(0, size, size)})
            mesh.positions.push_back(corner + offset);
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    for (int copies = 0; copies < 3; ++copies) {
        expect_same_trees({mesh}, "deep codes, doubled " + std::to_string(copies) + " times");
        const std::vector<glm::uvec3> once = mesh.triangles;
        mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
    }
    for (glm::vec3& p : mesh.positions) p = -p;
    expect_same_trees({mesh}, "deep codes, mirrored");
}

}  // namespace
}  // namespace claray::test
