// Rays that break ray tracers: edges, vertices, planes, slivers, huge and tiny coordinates, deep trees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "claray/query.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

class HardCase : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(const Mesh& mesh) { return Bvh::build(device(), std::span(&mesh, 1), {.layout = GetParam()}); }
};

Mesh translated(Mesh mesh, glm::vec3 by) {
    for (glm::vec3& p : mesh.positions) p += by;
    return mesh;
}

/// Rays from around `eye` through points of edges and through vertices, as exactly as float32 allows.
std::vector<Ray> edge_rays(const Mesh& mesh, glm::vec3 center, float radius, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::uvec3 t = mesh.triangles[random.below(std::uint32_t(mesh.triangles.size()))];
        const float s = i % 2 ? random.uniform() : 0.f;  // every second ray meets a vertex
        const glm::vec3 target = mesh.positions[t.x] + s * (mesh.positions[t.y] - mesh.positions[t.x]);
        const glm::vec3 origin = center + radius * random.in_cube(1.f);
        rays.push_back(make_ray(origin, target - origin));
    }
    return rays;
}

/// How many triangles claim each ray, without the tree.
std::vector<std::uint32_t> count_claims(const Bvh& bvh, const std::vector<Ray>& rays) {
    const char* source =
        "#include \"trace/triangle.clh\"\n"
        "#include \"claray/shared/bvh_node.h\"\n"
        "kernel void claims(global const BvhHeader* header, global const LeafTriangle* leaves, global const Ray* "
        "rays,\n"
        "                   global uint* counts) {\n"
        "    const uint i = get_global_id(0);\n"
        "    const PreparedRay ray = prepare_ray(rays[i], false, 0xffffffffu);\n"
        "    uint count = 0;\n"
        "    for (uint k = 0; k < header->valid; ++k) {\n"
        "        global const LeafTriangle* l = &leaves[k];\n"
        "        Hit hit = no_hit(rays[i].tmax);\n"
        "        count += exact_hit(&ray, (float3)(l->v0x, l->v0y, l->v0z), (float3)(l->v1x, l->v1y, l->v1z),\n"
        "                           (float3)(l->v2x, l->v2y, l->v2z), 0, 0, &hit);\n"
        "    }\n"
        "    counts[i] = count;\n"
        "}\n";
    const Buffer<Ray> device_rays(device(), rays);
    Buffer<std::uint32_t> counts(device(), rays.size());
    compile_kernel(device(), source, "claims")
        .run({rays.size()}, bvh.header_buffer(), bvh.leaves(), device_rays, counts);
    return counts.read();
}

TEST_P(HardCase, NoRayLeaksThroughEdgesOrVertices) {
    for (const glm::vec3 offset : {glm::vec3(0), glm::vec3(148376, 1234, -223423), glm::vec3(1e6f)}) {
        const Mesh mesh = translated(sphere(3, 100.f), offset);
        const Bvh bvh = build(mesh);
        // From the inside of a closed mesh every ray must hit, and leave exactly once.
        const std::vector<Ray> rays = edge_rays(mesh, offset, 20.f, 100'000, 1);
        std::size_t missed = 0;
        for (const Hit& hit : closest_hit(bvh, rays)) missed += hit.primitive == CLARAY_MISS;
        EXPECT_EQ(missed, 0u) << "offset " << offset.x;
    }
}

TEST_P(HardCase, ExactlyOneTriangleClaimsARayThroughAnEdge) {
    // Small integer coordinates make rays meet edges and vertices exactly: the determinants are true zeros.
    const Mesh mesh = grid(8);
    Mesh integers = mesh;
    for (glm::vec3& p : integers.positions) p = glm::round(p * 8.f);
    const Bvh bvh = build(integers);
    std::vector<Ray> rays;
    for (int y = 1; y < 16; ++y)
        for (int x = 1; x < 16; ++x)
            for (const glm::vec3 d :
                 {glm::vec3(0, 0, -1), glm::vec3(0, 0, -4), glm::vec3(1, 0, -8), glm::vec3(-2, 1, -8)})
                for (const float side : {1.f, -1.f}) {
                    const glm::vec3 target(float(x) * 0.5f, float(y) * 0.5f, 0), direction(d.x, d.y, d.z * side);
                    rays.push_back(make_ray(target - 4.f * direction, direction));
                }
    const std::vector<std::uint32_t> claims = count_claims(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const glm::vec2 target(rays[i].ox + 4 * rays[i].dx, rays[i].oy + 4 * rays[i].dy);
        const bool interior = target.x > 0 && target.x < 8 && target.y > 0 && target.y < 8;
        if (interior) {
            ASSERT_EQ(claims[i], 1u) << i;
        }
    }
}

TEST_P(HardCase, ClosedMeshesAreLeftAsOftenAsEntered) {
    const Mesh mesh = sphere(3);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> rays = edge_rays(mesh, glm::vec3(0, 0, 4), 1.f, 20'000, 2);
    for (const std::uint32_t claims : count_claims(bvh, rays)) ASSERT_EQ(claims % 2, 0u);
}

TEST_P(HardCase, AxisParallelRaysOnBoxFacesEqualTheOracle) {
    Mesh mesh = soup(400, 0.3f, 21);
    for (glm::vec3& p : mesh.positions) p = glm::round(p * 8.f) / 8.f;  // box faces on a lattice
    const Bvh bvh = build(mesh);
    Random random(22);
    std::vector<Ray> rays;
    for (int i = 0; i < 30'000; ++i) {
        const glm::vec3 vertex = mesh.positions[random.below(std::uint32_t(mesh.positions.size()))];
        const glm::vec3 other = mesh.positions[random.below(std::uint32_t(mesh.positions.size()))];
        const int axis = i % 3;
        glm::vec3 origin = vertex, direction(0.f);
        origin[(axis + 1) % 3] = other[(axis + 1) % 3] + (i % 2 ? random.uniform(-0.1f, 0.1f) : 0.f);
        origin[axis] = i % 4 < 2 ? -3.f : 3.f;
        direction[axis] = i % 4 < 2 ? 1.f : -1.f;
        if (i % 5 == 0) direction[(axis + 1) % 3] = -0.f;
        rays.push_back(make_ray(origin, direction));
    }
    // On a lattice rays graze edges exactly, where inclusive tests claim what a tie rule gives to the neighbour or to
    // nobody: the reference is the same exact test over every triangle.
    const std::vector<Hit> fast = closest_hit(bvh, rays), slow = closest_hit(bvh, rays, brute_force);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(fast[i].primitive, slow[i].primitive) << i;
        ASSERT_EQ(fast[i].t, slow[i].t) << i;
        hits += fast[i].primitive != CLARAY_MISS;
    }
    EXPECT_GT(hits, 3000u);
}

TEST_P(HardCase, ScaleChangesNoHit) {
    const Mesh mesh = soup(2003, 0.1f, 23);
    const std::vector<Ray> rays = random_rays(5003, 3.f, 1.f, 24);
    const std::vector<Hit> expected = closest_hit(build(mesh), rays);
    for (const int power : {-20, -10, 10, 20}) {
        Mesh scaled = mesh;
        for (glm::vec3& p : scaled.positions) p *= std::exp2(float(power));
        std::vector<Ray> scaled_rays = rays;
        for (Ray& r : scaled_rays)
            r.ox = std::ldexp(r.ox, power), r.oy = std::ldexp(r.oy, power), r.oz = std::ldexp(r.oz, power);
        const std::vector<Hit> hits = closest_hit(build(scaled), scaled_rays);
        for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(hits[i].primitive, expected[i].primitive) << power << ", " << i;
    }
}

TEST_P(HardCase, SliversAndTinyTrianglesEqualTheOracle) {
    Random random(25);
    Mesh mesh;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const glm::vec3 a = random.in_cube(1.f), along = random.in_cube(1.f);
        const float thickness = std::exp2(-float(random.below(30)));
        mesh.positions.insert(mesh.positions.end(), {a, a + along, a + 0.5f * along + thickness * random.in_cube(1.f)});
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    const std::vector<Ray> rays = random_rays(30'000, 3.f, 1.f, 26);
    const HitComparison result =
        compare(closest_hit(build(mesh), rays), Oracle(std::span(&mesh, 1)).closest_hits(rays));
    EXPECT_GT(result.hits, 1000u);
    EXPECT_EQ(result.wrong, 0u);
}

TEST_P(HardCase, RaysInTheTrianglesPlaneHitNothing) {
    const Mesh mesh = grid(16);
    const Bvh bvh = build(mesh);
    std::vector<Ray> rays;
    for (int i = 0; i < 1000; ++i)
        rays.push_back(make_ray({-1.f, float(i) / 999.f, 0.f}, {1.f, 0.001f * float(i % 7), 0.f}));
    for (const Hit& hit : closest_hit(bvh, rays)) EXPECT_EQ(hit.primitive, CLARAY_MISS);
}

TEST_P(HardCase, OfCoplanarDuplicatesTheFirstWins) {
    const Mesh base = soup(200, 0.3f, 27);
    const std::vector<Ray> rays = random_rays(3000, 3.f, 1.f, 28);
    const std::vector<Hit> expected = closest_hit(build(base), rays);
    Random random(29);
    for (int shuffle = 0; shuffle < 10; ++shuffle) {
        Mesh copies = base;
        for (int i = 0; i < 600; ++i) copies.triangles.push_back(base.triangles[random.below(200)]);
        // Copies behind the originals, whatever their order, must never be reported.
        for (std::size_t i = copies.triangles.size() - 1; i > 200; --i)
            std::swap(copies.triangles[i], copies.triangles[200 + random.below(std::uint32_t(i - 199))]);
        const std::vector<Hit> hits = closest_hit(build(copies), rays);
        for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(hits[i].primitive, expected[i].primitive) << shuffle << ", " << i;
    }
}

TEST_P(HardCase, HugeOffsetsEqualTheOracle) {
    for (const glm::vec3 offset : {glm::vec3(1e6f), glm::vec3(148376, 1234, -223423)}) {
        const Mesh mesh = translated(soup(1000, 20.f, 30), offset);
        std::vector<Ray> rays = random_rays(10'000, 100.f, 1.f, 31);
        for (Ray& r : rays) r.ox += offset.x, r.oy += offset.y, r.oz += offset.z;
        const HitComparison result =
            compare(closest_hit(build(mesh), rays), Oracle(std::span(&mesh, 1)).closest_hits(rays));
        EXPECT_GT(result.hits, 1000u);
        EXPECT_EQ(result.wrong, 0u);
    }
}

/// A chain of triangles at distances 2^-k, whose Morton codes share ever longer prefixes, on top of equal ones: as deep
/// as 63-bit codes allow.
TEST_P(HardCase, DeepTreesNeedNoMoreThanTheStack) {
    Mesh mesh;
    const auto add = [&](glm::vec3 at, float size) {
        const auto base = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {at, at + glm::vec3(size, 0, 0), at + glm::vec3(0, size, 0)});
        mesh.triangles.emplace_back(base, base + 1, base + 2);
    };
    for (int k = 0; k < 21; ++k)
        for (int corner = 1; corner < 8; ++corner)
            add(glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2) * std::exp2(-float(k)), std::exp2(-float(k) - 8.f));
    for (int copy = 0; copy < 4096; ++copy) add(glm::vec3(0), 1e-9f);
    const Bvh bvh = build(mesh);
    EXPECT_TRUE(bvh.validate().ok());
    EXPECT_GE(bvh.header().height, 60u);
    EXPECT_LE(bvh.header().height, unsigned(CLARAY_MAX_HEIGHT));
    // From afar float32 can't aim at such small triangles: many rays meet corners of lone triangles exactly, which the
    // tie rule gives to no one (as rasterisers do), so the reference is the same test over every triangle ...
    Random random(32);
    std::vector<Ray> far, near;
    for (int i = 0; i < 20'000; ++i) {
        const glm::uvec3 t = mesh.triangles[random.below(147)];
        const glm::vec3 a = mesh.positions[t.x], target = (a + mesh.positions[t.y] + mesh.positions[t.z]) / 3.f;
        const glm::vec3 origin(random.uniform(-1, 2), random.uniform(-1, 2), 3.f);
        far.push_back(make_ray(origin, target - origin));
        const float size = mesh.positions[t.y].x - a.x;
        const glm::vec3 close = target + size * (random.in_cube(0.5f) + glm::vec3(0, 0, 1));
        near.push_back(make_ray(close, {random.uniform(-0.2f, 0.2f), random.uniform(-0.2f, 0.2f), -1}));
    }
    const std::vector<Hit> fast = closest_hit(bvh, far), slow = closest_hit(bvh, far, brute_force);
    for (std::size_t i = 0; i < far.size(); ++i) ASSERT_EQ(fast[i].primitive, slow[i].primitive) << i;
    // ... and from nearby it can.
    const HitComparison result = compare(closest_hit(bvh, near), Oracle(std::span(&mesh, 1)).closest_hits(near));
    EXPECT_GT(result.hits, 5000u);
    EXPECT_EQ(result.wrong, 0u);
}

/// Half-open as in rasterisation: of a lone square, rays through its border hit two sides of the four.
TEST_P(HardCase, TheBorderOfAnOpenMeshIsHalfOpen) {
    const Bvh bvh = build(grid(1));
    std::vector<Ray> rays;
    for (const glm::vec3 at :
         {glm::vec3(0, 0.25f, 1), glm::vec3(1, 0.25f, 1), glm::vec3(0.25f, 0, 1), glm::vec3(0.25f, 1, 1)})
        rays.push_back(make_ray(at, {0, 0, -1}));
    std::size_t hits = 0;
    for (const Hit& hit : closest_hit(bvh, rays)) hits += hit.primitive != CLARAY_MISS;
    EXPECT_EQ(hits, 2u);
}

INSTANTIATE_TEST_SUITE_P(Layouts, HardCase, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

}  // namespace
}  // namespace claray::test
