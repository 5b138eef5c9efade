// Primitives given as text: primitives/primitives.cl.
#include "claray/primitives/primitives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "claray/instances.hpp"
#include "claray/query/all_hits.hpp"
#include "claray/query/overlaps.hpp"
#include "claray/query/points.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/verify/oracles/primitive_oracle.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

using KindCase = verify::ExactKind;
using verify::random_data;

class PrimitivesTest : public testing::TestWithParam<std::tuple<int, Layout>> {
protected:
    static KindCase kind_case() { return verify::exact_kinds()[std::size_t(std::get<0>(GetParam()))]; }
    static Primitives build(const PrimitiveKind& kind, const std::vector<float>& data,
                            Builder builder = Builder::balanced) {
        return Primitives::build(device(), kind, Buffer<float>(device(), data),
                                 std::uint32_t(data.size() / std::max(1u, kind.floats)),
                                 {.builder = builder, .layout = std::get<1>(GetParam())});
    }
};

void expect_oracle_hits(const KindCase& of, const std::vector<float>& data, const std::vector<Ray>& rays,
                        const std::vector<Hit>& hits) {
    std::size_t found = 0, marginal = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const verify::OracleHit nearest = verify::closest_primitive(of, data, rays[i]);
        if (hits[i].primitive == nearest.primitive &&
            (nearest.primitive == CLARAY_MISS || std::fabs(hits[i].t - nearest.t) <= 1e-7 * nearest.t)) {
            found += nearest.primitive != CLARAY_MISS;
            continue;
        }
        ++marginal;  // at a border, where float64 may round to the other side
    }
    EXPECT_GT(found, rays.size() / 10);
    EXPECT_LE(marginal, rays.size() / 5000);
}

TEST_P(PrimitivesTest, HitsEqualTheOracle) {
    const KindCase of = kind_case();
    const std::vector<float> data = random_data(of, 503, 0.15f, 1);
    std::vector<Ray> rays = random_rays(5003, 3.f, 1.f, 2);
    for (std::size_t i = 0; i < rays.size(); i += 3) rays[i].tmin = 2.5f, rays[i].tmax = 3.5f;  // some from inside
    expect_oracle_hits(of, data, rays, closest_hit(build(of.kind, data), rays));
}

TEST_P(PrimitivesTest, HitsDoNotDependOnTheTree) {
    const KindCase of = kind_case();
    std::vector<float> data = random_data(of, 1003, 0.1f, 3);
    data.insert(data.end(), data.begin(), data.begin() + 50 * of.kind.floats);  // equal distances
    const std::vector<Ray> rays = random_rays(3001, 3.f, 1.f, 4);
    const Primitives here = build(of.kind, data);
    const std::vector<Hit> hits = closest_hit(here, rays), every = closest_hit(here, rays, brute_force),
                           other = closest_hit(build(of.kind, data, Builder::high), rays);
    const std::vector<std::uint8_t> occluded = any_hit(here, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].primitive, every[i].primitive) << i;
        ASSERT_EQ(hits[i].t, every[i].t) << i;
        ASSERT_EQ(hits[i].u, every[i].u) << i;
        ASSERT_EQ(hits[i].primitive, other[i].primitive) << i;
        ASSERT_EQ(occluded[i] != 0, hits[i].primitive != CLARAY_MISS) << i;
        ASSERT_TRUE(hits[i].primitive < 1003 || hits[i].primitive == CLARAY_MISS) << "the copy was hit by ray " << i;
    }
    EXPECT_TRUE(here.bvh().validate().ok());
}

TEST_P(PrimitivesTest, FarAwayAndFewAndNone) {
    const KindCase of = kind_case();
    std::vector<float> data = random_data(of, 300, 1000.f, 5);
    for (std::size_t i = 0; i < data.size(); i += of.kind.floats) {
        for (int k = 0; k < 3; ++k) data[i + k] += 1e6f;
        if (of.name == std::string("cylinders"))
            for (int k = 4; k < 7; ++k) data[i + k] += 1e6f;
    }
    std::vector<Ray> rays = random_rays(2003, 5000.f, 500.f, 6);
    for (Ray& ray : rays) ray.ox += 1e6f, ray.oy += 1e6f, ray.oz += 1e6f;
    expect_oracle_hits(of, data, rays, closest_hit(build(of.kind, data), rays));
    for (const std::size_t count : {0, 1, 2}) {
        const std::vector<float> few(data.begin(), data.begin() + count * of.kind.floats);
        const Primitives primitives = build(of.kind, few);
        const std::vector<Hit> hits = closest_hit(primitives, rays), every = closest_hit(primitives, rays, brute_force);
        for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(hits[i].primitive, every[i].primitive) << i;
    }
    std::vector<float> invalid(data.begin(), data.begin() + 3 * of.kind.floats);
    invalid[0] = nan, invalid[of.kind.floats + 3] = -1;  // a centre and a radius
    EXPECT_EQ(build(of.kind, invalid).bvh().statistics().triangles, 1u);
}

/// The text of a user: cubes, whose bounds are all there is to them.
TEST(OwnPrimitives, OfAUsersText) {
    const PrimitiveKind cubes{"cubes", R"(
static inline PrimitiveBox bounds_of(global const float* data, uint primitive) {
    const float4 cube = vload4(primitive, data);
    const PrimitiveBox box = {cube.xyz - cube.w, cube.xyz + cube.w};
    return box;
}
static inline bool intersect(global const float* data, uint primitive, float3 origin, float3 direction, float tmin, Hit* hit) {
    const float4 cube = vload4(primitive, data);
    const float3 a = (cube.xyz - cube.w - origin) / direction, b = (cube.xyz + cube.w - origin) / direction;
    const float3 near = fmin(a, b), far = fmax(a, b);
    const float in = fmax(fmax(near.x, near.y), near.z), out = fmin(fmin(far.x, far.y), far.z);
    return in <= out && take_hit(in, tmin, hit);
})",
                              4};
    const std::vector<float> data = {0, 0, 0, 1, 5, 0, 0, 0.5f};
    const Primitives primitives = Primitives::build(device(), cubes, data);
    const std::vector<Ray> rays = {make_ray({0.1f, 0.2f, 4}, {0, 0, -1}), make_ray({-3, 0.1f, 0.2f}, {1, 0, 0}),
                                   make_ray({5, 0.1f, 4}, {0, 0, -2}), make_ray({2, 2, 2}, {1, 1, 1})};
    const std::vector<Hit> hits = closest_hit(primitives, rays);
    EXPECT_EQ(hits[0].t, 3.f);
    EXPECT_EQ(hits[1].t, 2.f);
    EXPECT_EQ(hits[2].primitive, 1u);
    EXPECT_EQ(hits[2].t, 1.75f);
    EXPECT_EQ(hits[3].primitive, CLARAY_MISS);
    EXPECT_EQ(any_hit(primitives, rays), (std::vector<std::uint8_t>{1, 1, 1, 0}));
}

TEST(OwnPrimitives, MoveWithTheirData) {
    const Buffer<float> data(device(), std::vector<float>{0, 0, 0, 1});
    Primitives primitives = Primitives::build(device(), sphere_kind(), data, 1);
    const std::vector<Ray> ray = {make_ray({5, 0, 4}, {0, 0, -1})};
    EXPECT_EQ(closest_hit(primitives, ray)[0].primitive, CLARAY_MISS);
    Buffer<float>(data).write(std::vector<float>{5, 0, 0, 2});
    primitives.refit();
    EXPECT_EQ(closest_hit(primitives, ray)[0].t, 2.f);
    Buffer<float>(data).write(std::vector<float>{5, 0, 0, 3});
    primitives.rebuild();
    EXPECT_EQ(closest_hit(primitives, ray)[0].t, 1.f);
}

/// Nodes are full where that costs least: seven of ten of their places are taken. Trees of CPUs, which test the eight
/// primitives of a leaf at once, fill their leaves, too.
TEST(OwnPrimitives, FillWideNodes) {
    const KindCase spheres = verify::exact_kinds()[0];
    const std::vector<float> data = random_data(spheres, 5003, 0.05f, 7);
    for (const Builder builder : {Builder::binned, Builder::balanced, Builder::fast}) {
        const Primitives primitives = Primitives::build(device(), spheres.kind, Buffer<float>(device(), data), 5003,
                                                        {.builder = builder, .layout = Layout::wide});
        const BvhHeader header = state_of(primitives.bvh()).read_header();
        std::vector<WideNode> wide(header.wide_nodes);
        state_of(primitives.bvh()).wide_nodes.read(std::span(wide));
        std::size_t nodes = 0, children = 0, blocks = 0;
        for (const WideNode& node : wide) {
            const auto used = std::count_if(node.child, node.child + CLARAY_WIDTH,
                                            [](std::uint32_t child) { return child != CLARAY_NO_CHILD; });
            nodes += used != 0, children += std::size_t(used);
            blocks += std::size_t(std::count_if(node.child, node.child + CLARAY_WIDTH, [](std::uint32_t child) {
                return child != CLARAY_NO_CHILD && (child & CLARAY_LEAF) != 0;
            }));
        }
        EXPECT_EQ(children, nodes - 1 + blocks);
        EXPECT_GT(double(children), 0.7 * CLARAY_WIDTH * double(nodes));
        if (builder == Builder::binned && device().info().type == DeviceType::cpu) {
            EXPECT_GT(5003.0, 6.5 * double(blocks));
        }
    }
}

/// On CPUs so many rays that are declared incoherent are traced in another order.
TEST(OwnPrimitives, SortedRaysHitTheSame) {
    const KindCase spheres = verify::exact_kinds()[0];
    const Primitives primitives = Primitives::build(device(), spheres.kind, random_data(spheres, 503, 0.1f, 8));
    const std::vector<Ray> rays = random_rays(65'537, 3.f, 1.f, 9);
    QueryOptions incoherent;
    incoherent.coherence = Coherence::incoherent;
    const std::vector<Hit> sorted = closest_hit(primitives, rays, incoherent), hits = closest_hit(primitives, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(sorted[i].primitive, hits[i].primitive) << i;
        ASSERT_EQ(sorted[i].t, hits[i].t) << i;
    }
}

TEST(OwnPrimitives, RefuseWhatCannotBe) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "whole number",
                             [] { (void)Primitives::build(device(), sphere_kind(), std::vector<float>(5)); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "need 8 floats",
                             [] { (void)Primitives::build(device(), sphere_kind(), Buffer<float>(device(), 7), 2); }));
    EXPECT_TRUE(throws_error(ErrorKind::device, "broken", [] {
        (void)Primitives::build(device(), {"broken", "static inline nonsense", 1}, std::vector<float>(1));
    }));
}

/// Its triangles are diagonals of boxes, which a kernel of triangles would hit in the binary layout.
TEST(OwnPrimitives, RefuseQueriesOfTriangles) {
    const std::vector<float> sphere = {0, 0, 0, 1};
    const std::vector<Ray> rays = {make_ray({0, 0, 4}, {0, 0, -1})};
    const std::vector<glm::vec3> points = {{2, 0, 0}};
    QueryOptions filtered;
    filtered.filter = geometry_range(device(), 0, 1);
    for (const Layout layout : {Layout::binary, Layout::wide}) {
        const Bvh bvh = Primitives::build(device(), sphere_kind(), Buffer<float>(device(), sphere), 1,
                                          {.builder = Builder::balanced, .layout = layout})
                            .bvh();
        const auto refused = [&](const char* user, const auto& query) {
            return throws_error(ErrorKind::usage, user + std::string(" needs a tree of triangles"), query);
        };
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)closest_hit(bvh, rays); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)closest_hit(bvh, rays, brute_force); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)any_hit(bvh, rays); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)Query(bvh, QueryKind::any); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)all_hits(bvh, rays); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)closest_hit(bvh, rays, filtered); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)nearest_point(bvh, points); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)signed_distance(bvh, points); }));
        EXPECT_TRUE(refused("a query of triangles", [&] { (void)sphere_overlaps(bvh, std::vector<Sphere>(1)); }));
        EXPECT_TRUE(refused("an instance", [&] {
            (void)InstancedBvh::build(std::span(&bvh, 1), std::vector{make_instance(glm::mat4(1.f))});
        }));
        EXPECT_TRUE(refused("a saved tree", [&] { bvh.save("primitives.cbvh"); }));
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, PrimitivesTest,
                         testing::Combine(testing::Range(0, 3), testing::Values(Layout::binary, Layout::wide)));

}  // namespace
}  // namespace claray::test
