// All hits of rays: trace/lists/all_hits.cl and trace/lists/lists.cl.
#include "claray/query/all_hits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "host/bvh/bvh_state.hpp"
#include "host/verify/exact.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

class AllHitsTest : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(const Mesh& mesh, Builder builder = Builder::fast) {
        return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .layout = GetParam()});
    }
};

bool before(const Hit& a, const Hit& b) { return a.t < b.t || (a.t == b.t && a.primitive < b.primitive); }

std::span<const Hit> list_of(const HostLists<Hit>& lists, std::size_t i) {
    return std::span(lists.elements).subspan(lists.offsets[i], lists.offsets[i + 1] - lists.offsets[i]);
}

/// Every triangle by exact arithmetic: one that a ray passes inside must be in the list, one that it misses must not.
void expect_all(const HostLists<Hit>& lists, const Mesh& mesh, const std::vector<Ray>& rays) {
    if (!device().info().fp64) GTEST_SKIP() << "hits are exact with float64 only";
    const Oracle oracle(std::span(&mesh, 1));
    ASSERT_EQ(lists.offsets.size(), rays.size() + 1);
    std::size_t total = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::span<const Hit> hits = list_of(lists, i);
        std::vector<bool> found(mesh.triangles.size());
        for (std::size_t k = 0; k < hits.size(); ++k) {
            found[hits[k].primitive] = true;
            ASSERT_TRUE(k == 0 || before(hits[k - 1], hits[k])) << "order of ray " << i;
        }
        for (std::size_t p = 0; p < mesh.triangles.size(); ++p) {
            const glm::uvec3 t = mesh.triangles[p];
            const verify::Place place =
                verify::place_of(rays[i], mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
            if (place == verify::Place::border) continue;
            const double distance = oracle.distance(rays[i], p);
            const bool hit =
                place == verify::Place::inside && float(distance) > rays[i].tmin && float(distance) <= rays[i].tmax;
            ASSERT_EQ(found[p], hit) << "ray " << i << ", triangle " << p;
            total += hit;
        }
    }
    EXPECT_GT(total, rays.size() / 4);
}

TEST_P(AllHitsTest, OfSoupAreThoseOfEveryTriangle) {
    const Mesh mesh = soup(1009, 0.3f, 1);
    std::vector<Ray> rays = random_rays(1003, 3.f, 1.f, 2);
    Random random(3);
    for (std::size_t i = 0; i < rays.size(); i += 3)
        rays[i].tmin = random.uniform(0.f, 3.f), rays[i].tmax = rays[i].tmin + random.uniform(0.f, 3.f);
    const HostLists<Hit> lists = all_hits(build(mesh), rays);
    expect_all(lists, mesh, rays);
    const std::vector<std::uint32_t> counts = count_hits(build(mesh), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(counts[i], list_of(lists, i).size()) << i;
}

TEST_P(AllHitsTest, DoNotDependOnTheTree) {
    Mesh mesh = ball_with_dust();
    for (std::uint32_t i = 0; i < 50; ++i) mesh.triangles.push_back(mesh.triangles[7 * i]);  // equal distances
    const std::vector<Ray> rays = random_rays(1001, 3.f, 1.f, 5);
    const Bvh split = build(mesh, Builder::high);
    EXPECT_GT(split.statistics().references, 50u);
    EXPECT_TRUE(state_of(split).splits());
    const HostLists<Hit> here = all_hits(build(mesh), rays), there = all_hits(split, rays);
    ASSERT_EQ(here.offsets, there.offsets);
    EXPECT_EQ(std::memcmp(here.elements.data(), there.elements.data(), here.elements.size() * sizeof(Hit)), 0);
    EXPECT_EQ(count_hits(build(mesh), rays), count_hits(split, rays));
    for (const Bvh& bvh : {build(mesh), split})
        for (const std::uint32_t most : {0u, 1u, 3u, 40u}) {
            const Buffer<Ray> on_device(device(), rays);
            Buffer<Hit> hits(device(), most * rays.size());
            Buffer<std::uint32_t> counts(device(), rays.size());
            nearest_hits(bvh, on_device, most, hits, counts);
            const std::vector<Hit> nearest = hits.read();
            const std::vector<std::uint32_t> numbers = counts.read();
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const std::span<const Hit> all = list_of(here, i);
                ASSERT_EQ(numbers[i], std::min<std::size_t>(most, all.size())) << i;
                ASSERT_TRUE(numbers[i] == 0 ||
                            std::memcmp(&nearest[i * most], all.data(), numbers[i] * sizeof(Hit)) == 0)
                    << i;
            }
        }
}

/// Rays at the vertices and the middles of edges of a closed mesh, from far outside, cross it an even number of times.
TEST_P(AllHitsTest, ThroughEdgesAndVerticesAreEven) {
    for (const Builder builder : {Builder::fast, Builder::high}) {
        const Mesh mesh = sphere(3);
        Random random(6);
        std::vector<Ray> rays;
        for (const glm::uvec3& t : mesh.triangles)
            for (const glm::vec3& target : {mesh.positions[t.x], 0.5f * (mesh.positions[t.y] + mesh.positions[t.z])}) {
                const glm::vec3 origin = 4.f * random.in_cube(1) + glm::vec3(0, 0, 8);
                rays.push_back(make_ray(origin, target - origin));
                rays.push_back(make_ray({target.x, target.y, -4.f}, {0, 0, 1}));  // along an axis: exactly
            }
        const std::vector<std::uint32_t> counts = count_hits(build(mesh, builder), rays);
        std::size_t twice = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(counts[i] % 2, 0u) << i;
            twice += counts[i] == 2;
        }
        EXPECT_GT(twice, rays.size() / 2);
    }
}

TEST_P(AllHitsTest, FollowTheOptions) {
    const Mesh mesh = sphere(2);
    const std::vector<Ray> rays = {make_ray({0.1f, 0.2f, 3}, {0, 0, -1})};
    EXPECT_EQ(count_hits(build(mesh), rays)[0], 2u);
    QueryOptions culling;
    culling.cull_back_faces = true;
    EXPECT_EQ(count_hits(build(mesh), rays, culling)[0], 1u);
    std::vector<Mesh> meshes = {grid(1), verify::translated(grid(1), {0, 0, 1})};
    meshes[0].mask = 1, meshes[1].mask = 2;
    const Bvh bvh = Bvh::build(device(), meshes, {.layout = GetParam()});
    const std::vector<Ray> four(4, make_ray({0.3f, 0.4f, 3}, {0, 0, -1}));
    QueryOptions masked;
    masked.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{1, 2, 3, 4});
    EXPECT_EQ(count_hits(bvh, four, masked), (std::vector<std::uint32_t>{1, 1, 2, 0}));
}

/// Filters by texts: trace/lists/filtered_hits.cl.
TEST_P(AllHitsTest, AreThoseThatAFilterAccepts) {
    const Mesh mesh = soup(1003, 0.3f, 7);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> rays = random_rays(2003, 3.f, 1.f, 8);
    const HostLists<Hit> all = all_hits(bvh, rays);
    QueryOptions options;
    options.filter = {"thirds",
                      "static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const "
                      "Hit* hit) { return hit->primitive % (uint)data[0] == 1 && hit->u < 0.5f; }",
                      Buffer<float>(device(), std::vector<float>{3})};
    const std::vector<Hit> closest = closest_hit(bvh, rays, options);
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays, options);
    const std::vector<std::uint32_t> counts = count_hits(bvh, rays, options);
    const HostLists<Hit> accepted = all_hits(bvh, rays, options);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        std::vector<Hit> expected;
        for (const Hit& hit : list_of(all, i))
            if (hit.primitive % 3 == 1 && hit.u < 0.5f) expected.push_back(hit);
        ASSERT_EQ(counts[i], expected.size()) << i;
        ASSERT_EQ(list_of(accepted, i).size(), expected.size()) << i;
        ASSERT_EQ(occluded[i] != 0, !expected.empty()) << i;
        ASSERT_EQ(closest[i].primitive, expected.empty() ? CLARAY_MISS : expected[0].primitive) << i;
        ASSERT_EQ(closest[i].t, expected.empty() ? rays[i].tmax : expected[0].t) << i;
    }
    options.brute_force = true;
    EXPECT_TRUE(throws_error(ErrorKind::usage, "filter", [&] { (void)closest_hit(bvh, rays, options); }));
}

TEST_P(AllHitsTest, AreThoseOfARangeOfMeshes) {
    std::vector<Mesh> meshes;
    for (int i = 0; i < 5; ++i) meshes.push_back(verify::translated(grid(1), {0, 0, float(i)}));
    const Bvh bvh = Bvh::build(device(), meshes, {.layout = GetParam()});
    const std::vector<Ray> rays = {make_ray({0.3f, 0.4f, 9}, {0, 0, -1})};
    QueryOptions options;
    options.filter = geometry_range(device(), 1, 3);
    EXPECT_EQ(closest_hit(bvh, rays, options)[0].geometry, 2u);
    EXPECT_EQ(count_hits(bvh, rays, options)[0], 2u);
    options.filter = geometry_range(device(), 3, 3);
    EXPECT_EQ(any_hit(bvh, rays, options)[0], 0);
}

/// The middle of a sheet of 2 x 2 squares is a vertex of six triangles.
TEST_P(AllHitsTest, OfClosedTrianglesAreAllThatARayTouches) {
    const Bvh bvh = build(grid(2), Builder::high);
    const auto down = [](float x, float y) { return make_ray({x, y, 1}, {0, 0, -1}); };
    const std::vector<Ray> rays = {down(0.5f, 0.5f), down(0.25f, 0.5f), down(0.2f, 0.1f),
                                   down(0, 0.25f),   down(1, 0.25f),    down(1.5f, 0.5f)};
    const QueryOptions closed = {.closed = true};
    EXPECT_EQ(count_hits(bvh, rays, closed), (std::vector<std::uint32_t>{6, 2, 1, 1, 1, 0}));
    const std::vector<std::uint32_t> counts = count_hits(bvh, rays);
    EXPECT_EQ((std::vector<std::uint32_t>(counts.begin(), counts.begin() + 3)), (std::vector<std::uint32_t>{1, 1, 1}));
    EXPECT_EQ(counts[3] + counts[4], 1u) << "half open: one of opposite borders";
    const HostLists<Hit> lists = all_hits(bvh, rays, closed);
    EXPECT_EQ(lists.offsets.back(), 11u);
}

TEST_P(AllHitsTest, OfNothingAreNone) {
    const std::vector<Ray> rays = {make_ray({0, 0, 3}, {0, 0, -1}), make_ray({0, 0, 3}, {0, 0, 0})};
    EXPECT_EQ(count_hits(build(Mesh{}), rays), (std::vector<std::uint32_t>{0, 0}));
    EXPECT_EQ(all_hits(build(grid(1)), std::vector<Ray>{}).offsets, (std::vector<std::uint32_t>{0}));
    EXPECT_EQ(all_hits(build(sphere(1), Builder::high), std::vector<Ray>{rays[1]}).offsets,
              (std::vector<std::uint32_t>{0, 0}));
}

TEST_P(AllHitsTest, RefuseShortBuffers) {
    const Bvh bvh = build(grid(1));
    const Buffer<Ray> rays(device(), 2);
    Buffer<Hit> hits(device(), 5);
    Buffer<std::uint32_t> two(device(), 2), one(device(), 1);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "2 rays", [&] { count_hits(bvh, rays, one); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "3 hits each", [&] { nearest_hits(bvh, rays, 3, hits, two); }));
}

INSTANTIATE_TEST_SUITE_P(Layouts, AllHitsTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "Wide" : "Binary"; });

}  // namespace
}  // namespace claray::test
