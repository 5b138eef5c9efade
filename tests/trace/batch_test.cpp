// Batches of rays on CPUs: packets of coherent rays and streams of others find the same hits as single rays, bit for
// bit.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/oracle/brute_force.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

bool same_or_both_missed(const Hit& a, const Hit& b) {
    const bool same_t = a.t == b.t || (std::isnan(a.t) && std::isnan(b.t));  // a miss returns the ray's tmax, even NaN
    return same_t && a.u == b.u && a.v == b.v && a.primitive == b.primitive && a.geometry == b.geometry;
}

/// The hits of rays that are traced one by one: counting their costs rules batches out.
std::vector<Hit> alone(const Bvh& bvh, const std::vector<Ray>& rays, QueryOptions options = {}) {
    Buffer<Hit> hits(device(), rays.size());
    options.visits = Buffer<Visits>(device(), rays.size());
    closest_hit(bvh, Buffer<Ray>(device(), rays), hits, options);
    return hits.read();
}

/// Compares batches with single rays, and returns the share of rays that hit.
double expect_same_as_alone(const Bvh& bvh, const std::vector<Ray>& rays, const QueryOptions& options = {}) {
    const std::vector<Hit> hits = closest_hit(bvh, rays, options), expected = alone(bvh, rays, options);
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays, options);
    std::size_t wrong = 0, wrong_any = 0, found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        wrong += !same_or_both_missed(hits[i], expected[i]);
        wrong_any += (occluded[i] != 0) != (expected[i].primitive != CLARAY_MISS);
        found += expected[i].primitive != CLARAY_MISS;
    }
    EXPECT_EQ(wrong, 0u) << "of " << rays.size();
    EXPECT_EQ(wrong_any, 0u) << "of " << rays.size();
    return rays.empty() ? 0.0 : double(found) / double(rays.size());
}

Bvh build(const Mesh& mesh) { return Bvh::build(device(), std::span(&mesh, 1), {.layout = Layout::wide}); }

TEST(Batch, CameraRaysHitAsAlone) {
    const Mesh mesh = soup(20'011, 0.05f, 1);
    const Bvh bvh = build(mesh);
    // Along each axis both ways, where slopes change their signs and components are zero, and obliquely.
    for (const glm::vec3 eye :
         {glm::vec3(0, 0, 3), glm::vec3(0, 0, -3), glm::vec3(3, 0, 0), glm::vec3(-3, 0, 0), glm::vec3(0, 3, 0),
          glm::vec3(0, -3, 0), glm::vec3(2, 1, 2), glm::vec3(0.1f, 0.2f, -0.1f)})
        EXPECT_GT(expect_same_as_alone(bvh, camera_rays(eye, glm::vec3(0.f), 129, 67)), 0.1);
}

TEST(Batch, CameraRaysEqualTheOracle) {
    if (!device().info().fp64) GTEST_SKIP() << "distances are exact with float64 only";
    const Mesh mesh = soup(3001, 0.2f, 2);
    const std::vector<Ray> rays = camera_rays({0.4f, 0.3f, 2.5f}, glm::vec3(0.f), 160, 90);
    const HitComparison result =
        compare(closest_hit(build(mesh), rays), Oracle(std::span(&mesh, 1)).closest_hits(rays));
    EXPECT_GT(result.hits, 1000u);
    EXPECT_EQ(result.wrong, 0u);
}

TEST(Batch, AnyNumberOfRays) {
    const Bvh bvh = build(soup(2000, 0.2f, 3));
    const std::vector<Ray> coherent = camera_rays({0, 0, 3}, glm::vec3(0.f), 128, 80);
    const std::vector<Ray> wild = random_rays(10'240, 1.5f, 1.f, 4);
    for (const std::size_t count :
         {1u, 2u, 15u, 16u, 17u, 63u, 64u, 65u, 127u, 255u, 256u, 257u, 1000u, 4097u, 10'240u}) {
        expect_same_as_alone(bvh, {coherent.begin(), coherent.begin() + std::ptrdiff_t(count)});
        expect_same_as_alone(bvh, {wild.begin(), wild.begin() + std::ptrdiff_t(count)});
    }
}

TEST(Batch, RaysToAPointAndParallelRays) {
    const Mesh mesh = soup(5000, 0.1f, 5);
    const Bvh bvh = build(mesh);
    const glm::vec3 light(0.7f, 5.f, 0.9f);
    std::vector<Ray> to_light, towards_sun;
    for (unsigned y = 0; y < 64; ++y)
        for (unsigned x = 0; x < 96; ++x) {
            const glm::vec3 from(float(x) / 48 - 1, -1.2f, float(y) / 32 - 1);
            to_light.push_back(make_ray(from, light - from, 0.f, 0.9999f));
            towards_sun.push_back(make_ray(from, {0.1f, 1.f, -0.2f}, 0.f, 100.f));
        }
    EXPECT_GT(expect_same_as_alone(bvh, to_light), 0.1);
    EXPECT_GT(expect_same_as_alone(bvh, towards_sun), 0.1);
}

// The lines of most packets meet in a light, but not in that of the packet before; those of others nearly meet there.
// Some rays end beyond their light, and some begin there.
TEST(Batch, RaysToSeveralLights) {
    const Bvh bvh = build(soup(5000, 0.1f, 5));
    const glm::vec3 lights[] = {{0.7f, 5.f, 0.9f}, {0.72f, 5.f, 0.9f}, {-3.f, 4.f, 2.f}, {0.1f, 0.2f, 0.3f}};
    std::vector<Ray> rays;
    Random random(31);
    for (unsigned y = 0; y < 64; ++y)
        for (unsigned x = 0; x < 96; ++x) {
            const glm::vec3 from(float(x) / 48 - 1, -1.2f, float(y) / 32 - 1);
            glm::vec3 light = lights[(x / 24 + y / 16) % 4];
            if (y % 8 == 0) light += 0.01f * random.in_cube(1.f);
            const float end = y % 16 < 12 ? 0.9999f : 3.f;
            rays.push_back(y % 16 < 14 ? make_ray(from, light - from, 0.f, end)
                                       : make_ray(light, from - light, 0.f, end));
        }
    EXPECT_GT(expect_same_as_alone(bvh, rays), 0.1);
}

// A packet's occluder is tried first by the next: two large triangles, whose shadow ends within packets. Every second
// ray passes near or through their edges. Then ranges that end or begin at the hit, or at the next number beside it.
TEST(Batch, RaysThatAlmostHitTheLastOccluder) {
    Mesh mesh = soup(2000, 0.02f, 33);
    const auto first = std::uint32_t(mesh.positions.size());
    const glm::vec3 corners[] = {{-0.8f, 1.1f, -0.7f}, {0.9f, 1.2f, -0.6f}, {0.7f, 1.3f, 0.8f}, {-0.6f, 1.15f, 0.9f}};
    mesh.positions.insert(mesh.positions.end(), std::begin(corners), std::end(corners));
    mesh.triangles.emplace_back(first, first + 1, first + 2), mesh.triangles.emplace_back(first, first + 2, first + 3);
    const Bvh bvh = build(mesh);
    const glm::vec3 light(0.3f, 6.f, 0.2f);
    std::vector<Ray> rays;
    for (unsigned y = 0; y < 64; ++y)
        for (unsigned x = 0; x < 96; ++x) {
            const glm::vec3 from(float(x) / 48 - 1, -1.2f, float(y) / 32 - 1);
            const glm::vec3 *a = &corners[x % 4], *b = &corners[(x + 1 + y % 2) % 4];
            const glm::vec3 on_edge = *a + float(y) / 64 * (*b - *a), behind = light + 1.5f * (on_edge - light);
            rays.push_back(x % 2 == 0 ? make_ray(from, light - from, 0.f, 0.9999f)
                                      : make_ray(behind, light - behind, 0.f, 1.f));
        }
    EXPECT_GT(expect_same_as_alone(bvh, rays), 0.3);
    const std::vector<Hit> hits = alone(bvh, rays);
    for (const int variant : {0, 1, 2, 3}) {
        std::vector<Ray> ranged = rays;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].primitive == CLARAY_MISS || i % 64 < 24) continue;  // so that packets have an occluder
            const float t = hits[i].t, less = std::nextafter(t, 0.f);
            (variant < 2 ? ranged[i].tmax : ranged[i].tmin) = variant % 2 == 0 ? t : less;
        }
        expect_same_as_alone(bvh, ranged);
    }
}

TEST(Batch, RandomRaysHitAsAlone) {
    const Bvh bvh = build(soup(20'011, 0.05f, 6));
    EXPECT_GT(expect_same_as_alone(bvh, random_rays(50'021, 1.5f, 1.f, 7)), 0.1);
    std::vector<Ray> bounded = random_rays(20'011, 1.5f, 1.f, 8);
    Random random(9);
    for (Ray& ray : bounded) ray.tmin = random.uniform(0.f, 2.f), ray.tmax = ray.tmin + random.uniform(0.f, 2.f);
    expect_same_as_alone(bvh, bounded);
}

TEST(Batch, ManyRaysInAnyOrderHitAsAlone) {  // enough of them to be sorted first
    std::vector<Mesh> meshes = {soup(4000, 0.1f, 20), soup(4000, 0.1f, 21)};
    meshes[0].mask = 1, meshes[1].mask = 2;
    const Bvh bvh = Bvh::build(device(), meshes, {.layout = Layout::wide});
    std::vector<Ray> rays = random_rays(60'011, 1.5f, 1.f, 22);
    const std::vector<Ray> pinhole = camera_rays({0.1f, 0.2f, 3}, glm::vec3(0.f), 121, 95);
    rays.insert(rays.end(), pinhole.begin(), pinhole.end());
    for (std::size_t i = 0; i < rays.size(); ++i) std::swap(rays[i], rays[i * 2654435761u % rays.size()]);
    for (std::size_t i = 0; i < rays.size(); i += 101) rays[i].ox = nan;
    for (std::size_t i = 1; i < rays.size(); i += 103) rays[i].tmax = 0.5f;
    EXPECT_GT(expect_same_as_alone(bvh, rays), 0.1);
    QueryOptions masked;
    std::vector<std::uint32_t> masks(rays.size());
    for (std::size_t i = 0; i < masks.size(); ++i) masks[i] = std::uint32_t(i * 2654435761u >> 30);
    masked.ray_masks = Buffer<std::uint32_t>(device(), masks);
    EXPECT_GT(expect_same_as_alone(bvh, rays, masked), 0.1);
}

/// Rays that end, or start, within roundings of a surface, before it and behind it.
TEST(Batch, RaysThatEndNearSurfaces) {
    const Mesh mesh = soup(3000, 0.2f, 23);
    const Bvh bvh = build(mesh);
    const glm::vec3 eye(0.3f, 0.2f, 3.f), sun(0.1f, 0.2f, -1.f);
    std::vector<Ray> parallel;
    for (unsigned y = 0; y < 80; ++y)
        for (unsigned x = 0; x < 120; ++x)
            parallel.push_back(make_ray({float(x) / 60 - 1, float(y) / 40 - 1, 2.f}, sun, 0.f, 100.f));
    std::size_t part = 0;
    for (std::vector<Ray> rays : {camera_rays(eye, glm::vec3(0.f), 120, 80), parallel}) {
        const std::vector<Hit> hits = alone(bvh, rays);
        std::vector<Ray> back = rays;  // from the surface to the eye
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const float factor = 1.f + float(int(i * 2654435761u % 15) - 7) * 0x1p-23f;
            if (hits[i].primitive == CLARAY_MISS) continue;
            rays[i].tmax = hits[i].t * factor;
            const glm::vec3 o(rays[i].ox, rays[i].oy, rays[i].oz), d(rays[i].dx, rays[i].dy, rays[i].dz);
            back[i] = make_ray(o + d * (hits[i].t * factor), -d * hits[i].t, 0.f, 0.9999f);
        }
        const double found = expect_same_as_alone(bvh, rays), back_found = expect_same_as_alone(bvh, back);
        EXPECT_GT(found, 0.1) << part;
        EXPECT_GT(back_found, 0.1) << part++;
    }
}

/// Rays from a light in the middle of a room to all sides, and back.
TEST(Batch, RaysFromALightToAllSides) {
    const Bvh bvh = build(soup(20'011, 0.05f, 24));
    const glm::vec3 light(0.05f, -0.1f, 0.15f);
    std::vector<Ray> from, to;
    for (unsigned y = 0; y < 100; ++y)
        for (unsigned x = 0; x < 200; ++x) {
            const float a = (float(x) + 0.5f) * 0.0314159f, z = (float(y) + 0.5f) / 50 - 1, r = std::sqrt(1 - z * z);
            const glm::vec3 d(r * std::cos(a), r * std::sin(a), z);
            from.push_back(make_ray(light, d));
            to.push_back(make_ray(light + 1.3f * d, -1.3f * d, 0.f, 0.9999f));
        }
    EXPECT_GT(expect_same_as_alone(bvh, from), 0.1);
    EXPECT_GT(expect_same_as_alone(bvh, to), 0.1);
}

TEST(Batch, CoherentAndRandomRaysMixed) {
    const Bvh bvh = build(soup(5000, 0.1f, 10));
    std::vector<Ray> rays = camera_rays({0, 0.5f, 3}, glm::vec3(0.f), 100, 41);
    const std::vector<Ray> wild = random_rays(3001, 1.5f, 1.f, 11);
    rays.insert(rays.begin() + 777, wild.begin(), wild.begin() + 1000);
    rays.insert(rays.end(), wild.begin() + 1000, wild.end());
    for (std::size_t i = 0; i < rays.size(); i += 97) rays[i] = wild[i % wild.size()];
    expect_same_as_alone(bvh, rays);
}

TEST(Batch, RaysThatAreNoRaysAmongOthers) {
    const Bvh bvh = build(soup(5000, 0.1f, 12));
    for (std::vector<Ray> rays : {camera_rays({0, 0, 3}, glm::vec3(0.f), 90, 90), random_rays(8001, 1.5f, 1.f, 13)}) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const std::size_t kind = i * 2654435761u % 41;
            if (kind == 0) rays[i].ox = nan;
            if (kind == 1) rays[i].dy = infinity;
            if (kind == 2) rays[i].dx = rays[i].dy = rays[i].dz = 0;
            if (kind == 3) rays[i].tmax = -1;
            if (kind == 4) rays[i].tmin = nan;
            if (kind == 5) rays[i].tmax = nan;
            if (kind == 6) rays[i].tmax = infinity;
        }
        rays[0].dz = nan;
        expect_same_as_alone(bvh, rays);
    }
    const std::vector<Ray> none(500, make_ray({nan, 0, 0}, {0, 0, 1}));
    EXPECT_EQ(expect_same_as_alone(bvh, none), 0.0);
}

TEST(Batch, EqualDistancesGoToTheLowestPrimitive) {
    Mesh mesh = sphere(3);
    const std::vector<glm::uvec3> once = mesh.triangles;
    for (int copy = 0; copy < 3; ++copy) mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
    const Bvh bvh = build(mesh);
    const std::vector<Ray> coherent = camera_rays({0, 0, 3}, glm::vec3(0.f), 120, 80, 0.4f);
    EXPECT_GT(expect_same_as_alone(bvh, coherent), 0.3);
    EXPECT_GT(expect_same_as_alone(bvh, random_rays(9001, 0.5f, 3.f, 14)), 0.9);
    for (const Hit& hit : closest_hit(bvh, coherent))
        ASSERT_TRUE(hit.primitive == CLARAY_MISS || hit.primitive < once.size());
}

TEST(Batch, RaysThroughEdgesOfAGridFarAway) {
    Mesh mesh = grid(32);
    const glm::vec3 offset(148376.f, 1234.f, -223423.f);
    for (glm::vec3& p : mesh.positions) p = p * 64.f + offset;
    const Bvh bvh = build(mesh);
    std::vector<Ray> rays;  // at vertices and at midpoints of edges
    for (int y = 1; y < 128; ++y)
        for (int x = 1; x < 128; ++x) {
            const glm::vec3 eye = offset + glm::vec3(31.f, 33.f, 100.f);
            rays.push_back(make_ray(eye, offset + glm::vec3(float(x) * 0.5f, float(y) * 0.5f, 0.f) - eye));
        }
    EXPECT_EQ(expect_same_as_alone(bvh, rays), 1.0);
}

TEST(Batch, MasksAndCulling) {
    std::vector<Mesh> meshes = {soup(2000, 0.1f, 15), soup(2000, 0.1f, 16)};
    meshes[0].mask = 1, meshes[1].mask = 2;
    const Bvh bvh = Bvh::build(device(), meshes, {.layout = Layout::wide});
    for (const std::vector<Ray>& rays :
         {camera_rays({0, 0, 3}, glm::vec3(0.f), 90, 90), random_rays(8001, 1.5f, 1.f, 17)}) {
        QueryOptions cull, masked;
        cull.cull_back_faces = true;
        std::vector<std::uint32_t> masks(rays.size());
        for (std::size_t i = 0; i < masks.size(); ++i) masks[i] = std::uint32_t(i * 2654435761u >> 30);
        masked.ray_masks = Buffer<std::uint32_t>(device(), masks);
        EXPECT_GT(expect_same_as_alone(bvh, rays, cull), 0.1);
        EXPECT_GT(expect_same_as_alone(bvh, rays, masked), 0.1);
    }
}

TEST(Batch, CountOnTheDevice) {
    const Bvh bvh = build(soup(2000, 0.2f, 18));
    const std::vector<Ray> host = camera_rays({0, 0, 3}, glm::vec3(0.f), 100, 50);
    const std::vector<Hit> expected = alone(bvh, host);
    const Buffer<Ray> rays(device(), host);
    Buffer<Hit> hits(device(), host.size());
    for (const std::uint32_t count : {0u, 1u, 64u, 65u, 1777u, 4999u, 5000u, 6000u}) {
        hits.fill(0x12345678u);
        closest_hit(bvh, rays, hits, {}, Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{count}));
        const std::vector<Hit> found = hits.read();
        for (std::size_t i = 0; i < host.size(); ++i) {
            if (i < count)
                ASSERT_TRUE(same_or_both_missed(found[i], expected[i])) << i << " of " << count;
            else
                ASSERT_EQ(found[i].geometry, 0x12345678u) << i << " of " << count;
        }
    }
}

TEST(Batch, TinyStructures) {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 5u, 9u}) {
        const Bvh bvh = build(soup(count, 0.8f, 40 + count));
        expect_same_as_alone(bvh, camera_rays({0, 0, 3}, glm::vec3(0.f), 64, 40));
        expect_same_as_alone(bvh, random_rays(2000, 1.5f, 1.f, 19));
    }
}

}  // namespace
}  // namespace claray::test
