// Queries: trace/closest_hit.cl, trace/any_hit.cl and trace/brute_force.cl.
#include "claray/query.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "host/bvh/host_tree.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

class QueryTest : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(std::span<const Mesh> meshes) { return Bvh::build(device(), meshes, {.layout = GetParam()}); }
    static Bvh build(const Mesh& mesh) { return build(std::span(&mesh, 1)); }
};

void expect_oracle_hits(const Bvh& bvh, const Mesh& mesh, const std::vector<Ray>& rays,
                        const QueryOptions& options = {}) {
    if (!device().info().fp64) GTEST_SKIP() << "hits are exact with float64 only";
    const HitComparison result =
        compare(closest_hit(bvh, rays, options), Oracle(std::span(&mesh, 1)).closest_hits(rays));
    EXPECT_GT(result.hits, 0u);
    EXPECT_EQ(result.wrong, 0u) << "of " << rays.size() << " rays, the first of them ray " << result.first_wrong;
    EXPECT_LE(result.worst_t_ulp, 0.51);
}

bool same(const Hit& a, const Hit& b) {
    return a.t == b.t && a.u == b.u && a.v == b.v && a.primitive == b.primitive && a.geometry == b.geometry;
}

TEST(HostTree, GivesTheSameHits) {
    const Mesh mesh = soup(5003, 0.1f, 1);
    const std::vector<Ray> rays = random_rays(5003, 2.f, 1.f, 2);
    const std::vector<Hit> host = closest_hit(build_by_host(device(), std::span(&mesh, 1), {}), rays),
                           other = closest_hit(Bvh::build(device(), std::span(&mesh, 1), {}), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(host[i], other[i])) << i;
}

TEST_P(QueryTest, ATreeFromElsewhereGivesTheSameHits) {
    const Mesh mesh = soup(5003, 0.1f, 1);
    const std::span<const Mesh> meshes(&mesh, 1);
    Bvh::Config config;
    config.layout = GetParam();
    const Bvh bvh = bvh_of(device(), meshes, build_host_tree(meshes), config);
    EXPECT_EQ(bvh.layout(), GetParam());
    expect_oracle_hits(bvh, mesh, random_rays(20'011, 3.f, 1.f, 2));
}

TEST_P(QueryTest, HitsOfSoupEqualTheOracle) {
    const Mesh mesh = soup(5003, 0.1f, 1);
    const Bvh bvh = build(mesh);
    expect_oracle_hits(bvh, mesh, random_rays(20'011, 3.f, 1.f, 2));
    expect_oracle_hits(bvh, mesh, random_rays(20'011, 0.3f, 1.f, 3));
}

TEST_P(QueryTest, HitsOfSphereEqualTheOracle) {
    const Mesh mesh = sphere(4);
    expect_oracle_hits(build(mesh), mesh, random_rays(20'011, 3.f, 1.f, 4));
}

TEST_P(QueryTest, BruteForceGivesTheSameHits) {
    const Mesh mesh = soup(1003, 0.2f, 5);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> rays = random_rays(3001, 3.f, 1.f, 6);
    const std::vector<Hit> fast = closest_hit(bvh, rays), slow = closest_hit(bvh, rays, brute_force);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(fast[i], slow[i])) << i;
    EXPECT_EQ(any_hit(bvh, rays), any_hit(bvh, rays, brute_force));
}

TEST_P(QueryTest, HitsDoNotDependOnLayoutOrBuilder) {
    const Mesh mesh = soup(4001, 0.2f, 7);
    const std::vector<Ray> rays = random_rays(20'001, 2.f, 1.f, 8);
    const std::vector<Hit> here = closest_hit(build(mesh), rays);
    const std::vector<Hit> binary =
        closest_hit(Bvh::build(device(), std::span(&mesh, 1), {.layout = Layout::binary}), rays);
    const std::vector<Hit> coarse =
        closest_hit(Bvh::build(device(), std::span(&mesh, 1),
                               {.builder = Builder::balanced, .morton_bits = 30, .layout = GetParam()}),
                    rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
        ASSERT_TRUE(same(here[i], binary[i]) && same(here[i], coarse[i])) << i;
}

TEST_P(QueryTest, AnyHitAgreesWithClosestHit) {
    const Mesh mesh = soup(2001, 0.1f, 9);
    const Bvh bvh = build(mesh);
    std::vector<Ray> rays = random_rays(10'007, 3.f, 1.f, 10);
    Random random(11);
    for (Ray& ray : rays) ray.tmin = random.uniform(0.f, 3.f), ray.tmax = ray.tmin + random.uniform(0.f, 2.f);
    const std::vector<Hit> hits = closest_hit(bvh, rays);
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays);
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(occluded[i] != 0, hits[i].primitive != CLARAY_MISS) << i;
        found += occluded[i];
    }
    EXPECT_GT(found, 100u);
    expect_oracle_hits(bvh, mesh, rays);
}

TEST_P(QueryTest, BarycentricsGiveTheHitPoint) {
    const Mesh mesh = soup(500, 0.3f, 12);
    const std::vector<Ray> rays = random_rays(5000, 3.f, 1.f, 13);
    const std::vector<Hit> hits = closest_hit(build(mesh), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].primitive == CLARAY_MISS) continue;
        const glm::uvec3 t = mesh.triangles[hits[i].primitive];
        const double u = hits[i].u, v = hits[i].v;
        const glm::dvec3 p = (1 - u - v) * glm::dvec3(mesh.positions[t.x]) + u * glm::dvec3(mesh.positions[t.y]) +
                             v * glm::dvec3(mesh.positions[t.z]);
        const glm::dvec3 q = glm::dvec3(rays[i].ox, rays[i].oy, rays[i].oz) +
                             double(hits[i].t) * glm::dvec3(rays[i].dx, rays[i].dy, rays[i].dz);
        ASSERT_LT(glm::distance(p, q), 2e-6) << i;
        ASSERT_GE(hits[i].u, 0.f);
        ASSERT_GE(hits[i].v, 0.f);
    }
}

TEST_P(QueryTest, RangeIsOpenAtTminAndClosedAtTmax) {
    const Mesh mesh = grid(1);  // z = 0
    const Bvh bvh = build(mesh);
    const glm::vec3 origin(0.3f, 0.4f, 1.f), down(0, 0, -1);
    const float after = std::nextafter(1.f, 2.f), before = std::nextafter(1.f, 0.f);
    const std::vector<Ray> rays = {make_ray(origin, down, 0, 1.f),      make_ray(origin, down, 0, before),
                                   make_ray(origin, down, 1.f, 2.f),    make_ray(origin, down, before, 2.f),
                                   make_ray(origin, down, 0, infinity), make_ray(origin, down, after, 2.f)};
    const bool expected[] = {true, false, false, true, true, false};
    // By itself, among others, one ray at a time, and without the tree.
    QueryOptions incoherent, one_by_one, brute_force;
    incoherent.coherence = Coherence::incoherent, brute_force.brute_force = true;
    one_by_one.visits = Buffer<Visits>(device(), rays.size());
    for (const QueryOptions& options : {QueryOptions{}, incoherent, one_by_one, brute_force}) {
        const std::vector<Hit> hits = closest_hit(bvh, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(hits[i].primitive != CLARAY_MISS, expected[i]) << i;
            EXPECT_EQ(hits[i].t, expected[i] ? 1.f : rays[i].tmax) << i;
        }
    }
}

/// So small that the products of a triangle test underflow.
TEST_P(QueryTest, MinuteScenesAreHitAsOthers) {
    if (!device().info().fp64) GTEST_SKIP() << "products of such lengths underflow in float32";
    const Mesh mesh = sphere(3);
    std::vector<Ray> rays;
    Random random(9);
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 from = 3.f * glm::normalize(glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), 1.f));
        rays.push_back(make_ray(from, glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0.f) - from));
    }
    const std::vector<Hit> expected = closest_hit(build(mesh), rays);
    for (const int power : {-50, -58, -62, -66}) {
        Mesh small = mesh;
        for (glm::vec3& p : small.positions) p *= std::exp2(float(power));
        std::vector<Ray> close = rays;
        for (Ray& r : close)
            r.ox = std::ldexp(r.ox, power), r.oy = std::ldexp(r.oy, power), r.oz = std::ldexp(r.oz, power);
        const Bvh bvh = build(small);
        QueryOptions one_by_one, brute_force;
        one_by_one.visits = Buffer<Visits>(device(), rays.size()), brute_force.brute_force = true;
        for (const QueryOptions& options : {QueryOptions{}, one_by_one, brute_force}) {
            const std::vector<Hit> hits = closest_hit(bvh, close, options);
            for (std::size_t i = 0; i < rays.size(); ++i)
                ASSERT_EQ(hits[i].primitive, expected[i].primitive) << "2^" << power << ", ray " << i;
        }
    }
}

TEST_P(QueryTest, CullsBackFaces) {
    const Mesh mesh = sphere(3);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> outside = random_rays(2000, 3.f, 0.5f, 14), inside = random_rays(2000, 0.2f, 5.f, 15);
    QueryOptions cull;
    cull.cull_back_faces = true;
    const std::vector<Hit> front = closest_hit(bvh, outside, cull), all = closest_hit(bvh, outside);
    for (std::size_t i = 0; i < outside.size(); ++i) ASSERT_TRUE(same(front[i], all[i]));
    for (const Hit& hit : closest_hit(bvh, inside, cull)) ASSERT_EQ(hit.primitive, CLARAY_MISS);
    for (const Hit& hit : closest_hit(bvh, inside)) ASSERT_NE(hit.primitive, CLARAY_MISS);
    for (const std::uint8_t occluded : any_hit(bvh, inside, cull)) ASSERT_EQ(occluded, 0);
}

TEST_P(QueryTest, MasksAndGeometriesTellMeshesApart) {
    std::vector<Mesh> meshes = {grid(3), grid(3), sphere(1, 0.5f, {0.5f, 0.5f, -3.f})};
    for (glm::vec3& p : meshes[1].positions) p.z = -1.f;
    meshes[0].mask = 1, meshes[1].mask = 2, meshes[2].mask = 4;
    const Bvh bvh = build(meshes);
    const std::vector<Ray> rays(8, make_ray({0.4f, 0.45f, 1.f}, {0, 0, -1}));
    const Buffer<std::uint32_t> masks(device(), std::vector<std::uint32_t>{1, 2, 3, 4, 6, 8, 0, 0xffffffff});
    QueryOptions with_masks;
    with_masks.ray_masks = masks;
    const std::vector<Hit> hits = closest_hit(bvh, rays, with_masks);
    const std::uint32_t miss = CLARAY_MISS, expected[] = {0, 1, 0, 2, 1, miss, miss, 0};
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays, with_masks);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(hits[i].geometry, expected[i]) << i;
        EXPECT_EQ(occluded[i] != 0, expected[i] != miss) << i;
    }
    EXPECT_EQ(closest_hit(bvh, rays)[5].geometry, 0u);
    EXPECT_GE(hits[3].primitive, meshes[0].triangles.size() + meshes[1].triangles.size());
}

Bounds scaled(const Bounds& bounds, float factor) {
    return {bounds.center() + factor * (bounds.lo - bounds.center()),
            bounds.center() + factor * (bounds.hi - bounds.center())};
}

/// Whether a ray meets a box, in float64.
bool meets(const Bounds& box, const Ray& ray) {
    double enter = ray.tmin, leave = ray.tmax;
    const double origin[] = {ray.ox, ray.oy, ray.oz}, direction[] = {ray.dx, ray.dy, ray.dz};
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (double(box.lo[axis]) - origin[axis]) / direction[axis],
                     b = (double(box.hi[axis]) - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
}

TEST_P(QueryTest, CountsVisits) {
    const Mesh mesh = soup(2000, 0.05f, 16);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> host = random_rays(1000, 3.f, 2.f, 17);
    const Buffer<Ray> rays(device(), host);
    Buffer<Hit> hits(device(), host.size());
    Buffer<Visits> visits(device(), host.size());
    QueryOptions counting;
    counting.visits = visits;
    closest_hit(bvh, rays, hits, counting);
    const std::vector<Hit> expected = closest_hit(bvh, host);
    const std::vector<Visits> counts = visits.read();
    const std::vector<Hit> found = hits.read();
    const Bounds bounds = bounds_of(mesh);
    unsigned beside = 0, through = 0;
    for (std::size_t i = 0; i < host.size(); ++i) {
        ASSERT_TRUE(same(found[i], expected[i]));
        ASSERT_GE(counts[i].triangles, found[i].primitive != CLARAY_MISS ? 1u : 0u);
        ASSERT_LE(counts[i].triangles, 2000u);
        // The box of all triangles is tested first: beside it, that is the only one.
        if (!meets(scaled(bounds, 1.001f), host[i])) {
            ASSERT_EQ(counts[i].nodes, 1u);
            ++beside;
        } else if (meets(scaled(bounds, 0.999f), host[i])) {
            ASSERT_GE(counts[i].nodes, 3u);
            ++through;
        }
    }
    EXPECT_GT(beside, 100u);
    EXPECT_GT(through, 100u);
}

TEST_P(QueryTest, RaysThatAreNoRaysHitNothing) {
    const Bvh bvh = build(sphere(2));
    const glm::vec3 o(0, 0, 3), d(0, 0, -1);
    const std::vector<Ray> rays = {make_ray({nan, 0, 3}, d),      make_ray(o, {0, nan, -1}),
                                   make_ray(o, {0, 0, 0}),        make_ray(o, {0, 0, -infinity}),
                                   make_ray({0, infinity, 0}, d), make_ray(o, d, nan, 9),
                                   make_ray(o, d, 0, nan),        make_ray(o, d, 5, 4)};
    for (const Hit& hit : closest_hit(bvh, rays)) EXPECT_EQ(hit.primitive, CLARAY_MISS);
    for (const std::uint8_t occluded : any_hit(bvh, rays)) EXPECT_EQ(occluded, 0);
}

TEST_P(QueryTest, TracesNoRays) {
    const Bvh bvh = build(sphere(1));
    EXPECT_TRUE(closest_hit(bvh, std::span<const Ray>()).empty());
    EXPECT_TRUE(any_hit(bvh, std::span<const Ray>()).empty());
}

TEST_P(QueryTest, CountOnTheDeviceLimitsTheRays) {
    const Bvh bvh = build(sphere(2));
    const Buffer<Ray> rays(device(), std::vector<Ray>(100, make_ray({0, 0, 3}, {0, 0.01f, -1})));
    Buffer<Hit> hits(device(), 100);
    hits.fill(0x12345678u);
    closest_hit(bvh, rays, hits, {}, Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{37}));
    const std::vector<Hit> found = hits.read();
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(found[i].geometry, i < 37 ? 0u : 0x12345678u) << i;
    Buffer<std::uint8_t> occluded(device(), 100);
    EXPECT_NO_THROW(
        any_hit(bvh, rays, occluded, {}, Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{1000})));
    EXPECT_EQ(occluded.read(), std::vector<std::uint8_t>(100, 1));
}

TEST_P(QueryTest, RefusesBuffersThatAreTooSmall) {
    const Bvh bvh = build(sphere(1));
    const Buffer<Ray> rays(device(), 10);
    Buffer<Hit> few(device(), 9), enough(device(), 10);
    EXPECT_THROW(closest_hit(bvh, rays, few), Error);
    QueryOptions few_masks, few_visits;
    few_masks.ray_masks = Buffer<std::uint32_t>(device(), 9);
    few_visits.visits = Buffer<Visits>(device(), 9);
    EXPECT_THROW(closest_hit(bvh, rays, enough, few_masks), Error);
    EXPECT_THROW(closest_hit(bvh, rays, enough, few_visits), Error);
}

TEST_P(QueryTest, OwnKernelsTraceToo) {
    const Mesh mesh = soup(1000, 0.2f, 19);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> rays = random_rays(999, 3.f, 1.f, 20);
    const Buffer<Ray> device_rays(device(), rays);
    Buffer<float> distances(device(), rays.size());
    Buffer<std::uint32_t> occluded(device(), rays.size());
    const char* source =
        "#include \"trace/closest_hit.clh\"\n"
        "kernel void mine(CLARAY_BVH_PARAMETERS, global const Ray* rays, global float* t, global uint* any) {\n"
        "    const uint i = get_global_id(0);\n"
        "    t[i] = claray_closest_hit(CLARAY_BVH, rays[i]).t;\n"
        "    any[i] = claray_any_hit(CLARAY_BVH, rays[i]);\n"
        "}\n";
    EXPECT_TRUE(throws_error(ErrorKind::usage, "not compiled for this structure", [&] {
        compile_kernel(device(), source, "mine").run({rays.size()}, bvh, device_rays, distances, occluded);
    }));
    compile_kernel(device(), source, "mine", bvh.defines()).run({rays.size()}, bvh, device_rays, distances, occluded);
    const std::vector<Hit> hits = closest_hit(bvh, rays);
    const std::vector<float> t = distances.read();
    const std::vector<std::uint32_t> any = occluded.read();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(t[i], hits[i].t);
        ASSERT_EQ(any[i] != 0, hits[i].primitive != CLARAY_MISS);
    }
}

/// Boxes that begin exactly where the nearest hit so far lies must still be looked into: seen from the origin of
/// coordinates, where nothing but roundings of the distance itself are left.
TEST_P(QueryTest, OfManySheetsInOnePlaneTheFirstWins) {
    Random random(31);
    Mesh mesh;
    for (const unsigned n : {17u, 5u, 13u, 7u, 16u, 11u}) {
        Mesh sheet = grid(n);
        for (glm::vec3& p : sheet.positions) p = {2.f * p.x - 1.f, 2.f * p.y - 1.f, 1.7f};
        for (std::size_t i = sheet.triangles.size(); i > 1; --i)
            std::swap(sheet.triangles[i - 1], sheet.triangles[random.below(std::uint32_t(i))]);
        const auto first = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), sheet.positions.begin(), sheet.positions.end());
        for (const glm::uvec3& t : sheet.triangles) mesh.triangles.push_back(t + first);
    }
    std::vector<Ray> rays(20'000);
    for (Ray& ray : rays) {
        const glm::vec3 target(random.uniform(-1.f, 1.f), random.uniform(-1.f, 1.f), 1.7f);
        ray = make_ray({}, random.uniform(0.1f, 2.f) * target);
    }
    const Bvh bvh = build(mesh);
    const std::vector<Hit> hits = closest_hit(bvh, rays), expected = closest_hit(bvh, rays, brute_force);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(hits[i], expected[i])) << i;
}

INSTANTIATE_TEST_SUITE_P(Layouts, QueryTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

TEST(QueryBuffers, OfAnotherContextAreRefused) {
    const Mesh mesh = grid(1);
    const Bvh bvh = Bvh::build(device(), std::span(&mesh, 1));
    const Device stranger = Device::open(std::to_string(device().info().index));
    const std::vector<Ray> rays = {make_ray({0.3f, 0.4f, 9}, {0, 0, -1})};
    const Buffer<Ray> own(device(), rays), foreign(stranger, rays);
    Buffer<Hit> hits(device(), 1), foreign_hits(stranger, 1);
    Buffer<std::uint8_t> foreign_bytes(stranger, 1);
    QueryOptions masked;
    masked.ray_masks = Buffer<std::uint32_t>(stranger, 1);
    const auto refused = [](const auto& call) { return throws_error(ErrorKind::usage, "another context", call); };
    EXPECT_TRUE(refused([&] { closest_hit(bvh, foreign, hits); }));
    EXPECT_TRUE(refused([&] { closest_hit(bvh, own, foreign_hits); }));
    EXPECT_TRUE(refused([&] { closest_hit(bvh, own, hits, masked); }));
    EXPECT_TRUE(refused([&] { any_hit(bvh, own, foreign_bytes); }));
    const TriangleBuffers buffers = {Buffer<float>(stranger, 9), Buffer<std::uint32_t>(stranger, 3)};
    EXPECT_TRUE(refused([&] { static_cast<void>(Bvh::build(device(), buffers)); }));
    closest_hit(bvh, own, hits);
    EXPECT_EQ(hits.read()[0].t, 9.f);
}

}  // namespace
}  // namespace claray::test
