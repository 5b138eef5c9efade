// What float32 leaves in doubt in the binary tree (trace/traverse_binary.clh): the second filter near the triangle, and
// the walk that goes on after a doubt.
#include <gtest/gtest.h>

#include <cmath>

#include "claray/program.hpp"
#include "claray/shared/bvh_node.h"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

using Vector = glm::vec<3, long double>;

/// What is so, to many more bits than float32 has: the smallest barycentric weight, and the distance.
struct Truth {
    long double inside, t;
};

Truth truth_of(const Ray& ray, const LeafTriangle& leaf) {
    const Vector a(leaf.v0x, leaf.v0y, leaf.v0z), o(ray.ox, ray.oy, ray.oz), d(ray.dx, ray.dy, ray.dz);
    const Vector e1 = Vector(leaf.v1x, leaf.v1y, leaf.v1z) - a, e2 = Vector(leaf.v2x, leaf.v2y, leaf.v2z) - a;
    const Vector p = glm::cross(d, e2), q = glm::cross(o - a, e1);
    const long double det = glm::dot(e1, p), u = glm::dot(o - a, p) / det, v = glm::dot(d, q) / det;
    return {std::min({u, v, 1 - u - v}), glm::dot(e2, q) / det};
}

/// Triangles as large as 1, and rays from `distance` away that pass one of their edges by a millionth to a tenth.
void make_cases(std::size_t count, float distance, std::vector<Ray>& rays, std::vector<LeafTriangle>& leaves) {
    Random random(17);
    rays.resize(count), leaves.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 at = 3.f * random.in_cube(1.f), a = at + random.in_cube(1.f), b = at + random.in_cube(1.f),
                        c = at + random.in_cube(1.f);
        leaves[i] = {a.x, a.y, a.z, std::uint32_t(i), b.x, b.y, b.z, 0, c.x, c.y, c.z, ~0u};
        const float along = random.uniform(), aside = std::pow(10.f, -1 - 5 * random.uniform());
        const glm::vec3 target = glm::mix(glm::mix(a, b, along), c, i % 2 == 0 ? aside : -aside);
        const glm::vec3 origin = at + distance * glm::normalize(random.in_cube(1.f));
        const glm::vec3 d = (target - origin) * (0.01f + random.uniform());
        rays[i] = {origin.x, origin.y, origin.z, 0.f, d.x, d.y, d.z, 1e30f};
    }
}

/// Long, thin triangles along an axis, as in buildings, and rays that start a little above or below them and pass them
/// near one end.
void make_slivers(std::size_t count, std::vector<Ray>& rays, std::vector<LeafTriangle>& leaves) {
    Random random(29);
    rays.resize(count), leaves.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const int axis = int(i % 3);
        glm::vec3 along(0.f), aside = 0.4f * random.in_cube(1.f);
        along[axis] = 300.f;
        const glm::vec3 a = 100.f * random.in_cube(1.f), b = a + along, c = b + aside;
        leaves[i] = {a.x, a.y, a.z, std::uint32_t(i), b.x, b.y, b.z, 0, c.x, c.y, c.z, ~0u};
        const glm::vec3 normal = glm::normalize(glm::cross(along, aside));
        const glm::vec3 at =
            glm::mix(a, glm::mix(b, c, 0.1f + 0.8f * random.uniform()), 0.5f + 0.4f * random.uniform());
        const glm::vec3 d = glm::normalize(normal + 0.9f * glm::normalize(random.in_cube(1.f)));
        const glm::vec3 origin = at + 0.01f * (i % 2 == 0 ? d : -d);
        rays[i] = {origin.x, origin.y, origin.z, 0.f, d.x, d.y, d.z, 1e30f};
    }
}

struct Outcomes {
    std::size_t wrong = 0, doubtful = 0, hits = 0;
};

/// Compares the fast hit test with the truth, which is certain unless a barycentric weight is within 1e-10 of 0.
Outcomes judge(const std::vector<glm::vec4>& outcomes, const std::vector<Ray>& rays,
               const std::vector<LeafTriangle>& leaves) {
    enum { rejected, replaced, doubtful };
    Outcomes result;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Truth truth = truth_of(rays[i], leaves[i]);
        const int outcome = int(outcomes[i].x);
        const bool sure = std::fabs(truth.inside) > 1e-10L, hits = truth.inside > 0 && truth.t > 0;
        result.doubtful += outcome == doubtful;
        result.hits += outcome == replaced;
        if (outcome == rejected) result.wrong += sure && hits;
        if (outcome == replaced) result.wrong += (sure && !hits) || truth.t < outcomes[i].y || truth.t > outcomes[i].z;
    }
    return result;
}

/// What the filter and the second filter say.
std::pair<Outcomes, Outcomes> judge_filters(const std::vector<Ray>& rays, const std::vector<LeafTriangle>& leaves) {
    Kernel filters = compile_kernel(device(), R"(
        #include "trace/traverse_binary.clh"
        kernel void filters(uint count, global const Ray* rays, global const LeafTriangle* leaves, global float4* far,
                            global float4* nearby) {
            const uint i = get_global_id(0);
            if (i >= count) return;
            const PreparedRay ray = prepare_ray(rays[i], false, 0xffffffffu);
            Candidate best = no_candidate(rays[i].tmax);
            const uint outcome = filter_leaf(&ray, leaves, i, &best);
            far[i] = (float4)(outcome, best.near, best.far, 0.0f);
            best = no_candidate(rays[i].tmax);
            const uint again = filter_nearby(&ray, leaves, i, &best);
            nearby[i] = (float4)(again, best.near, best.far, 0.0f);
        })",
                                    "filters");
    Buffer<glm::vec4> far(device(), rays.size()), nearby(device(), rays.size());
    filters.run({rays.size(), 64}, std::uint32_t(rays.size()), Buffer<Ray>(device(), rays),
                Buffer<LeafTriangle>(device(), leaves), far, nearby);
    return {judge(far.read(), rays, leaves), judge(nearby.read(), rays, leaves)};
}

TEST(Doubts, FiltersAreRightWhereTheyAreCertain) {
    constexpr std::size_t count = 200'000;
    for (const float distance : {3.f, 300.f, 30'000.f, 3e6f}) {
        std::vector<Ray> rays;
        std::vector<LeafTriangle> leaves;
        make_cases(count, distance, rays, leaves);
        const auto [first, second] = judge_filters(rays, leaves);
        EXPECT_EQ(first.wrong, 0u) << distance;
        EXPECT_EQ(second.wrong, 0u) << distance;
        EXPECT_GT(second.hits, count / 4) << distance;
        EXPECT_LT(second.doubtful, count / 5) << distance;
        EXPECT_LE(second.doubtful, first.doubtful) << distance;
    }
}

TEST(Doubts, RaysOnLongThinTrianglesAreSoonDecided) {
    constexpr std::size_t count = 20'000;
    std::vector<Ray> rays;
    std::vector<LeafTriangle> leaves;
    make_slivers(count, rays, leaves);
    const auto [first, second] = judge_filters(rays, leaves);
    EXPECT_EQ(first.wrong, 0u);
    EXPECT_EQ(second.wrong, 0u);
    EXPECT_GT(first.doubtful, count / 2) << "or the case is not hard";
    EXPECT_LT(second.doubtful, count / 100);
    EXPECT_GT(second.hits, count * 4 / 10);
}

/// Rays from afar at points on the mesh's edges, all around it.
std::vector<Ray> rays_at_edges(const Mesh& mesh, std::size_t count, float distance) {
    Random random(23);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        const glm::uvec3 triangle = mesh.triangles[random.below(std::uint32_t(mesh.triangles.size()))];
        const glm::vec3 target = glm::mix(mesh.positions[triangle[0]], mesh.positions[triangle[1]], random.uniform());
        const glm::vec3 origin = distance * glm::normalize(random.in_cube(1.f));
        ray = make_ray(origin, target - origin);
    }
    return rays;
}

TEST(Doubts, AreDecidedAsOnTheWideTree) {
    if (!device().info().fp64) GTEST_SKIP() << "the layouts agree on what is decided in float64 only";
    const Mesh mesh = sphere(4);
    const Bvh binary = Bvh::build(device(), std::span(&mesh, 1), {.builder = Builder::high, .layout = Layout::binary}),
              wide = Bvh::build(device(), std::span(&mesh, 1), {.layout = Layout::wide});
    for (const float distance : {2.f, 2'000.f, 2e6f}) {
        const std::vector<Ray> rays = rays_at_edges(mesh, 20'000, distance);
        for (const bool cull : {false, true}) {
            QueryOptions options;
            options.cull_back_faces = cull;
            const std::vector<Hit> a = closest_hit(binary, rays, options), b = closest_hit(wide, rays, options);
            const std::vector<std::uint8_t> occluded = any_hit(binary, rays, options);
            std::size_t hits = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                ASSERT_EQ(a[i].primitive, b[i].primitive) << distance << ' ' << i;
                ASSERT_EQ(a[i].t, b[i].t) << distance << ' ' << i;
                ASSERT_EQ(occluded[i] != 0, a[i].primitive != CLARAY_MISS) << distance << ' ' << i;
                hits += occluded[i];
            }
            EXPECT_GT(hits, rays.size() / 2);
        }
    }
}

}  // namespace
}  // namespace claray::test
