// Rays that leave a surface must not meet it again, at any scale and distance from the origin, and must not begin far
// off.
#include <gtest/gtest.h>

#include <algorithm>

#include "claray/program.hpp"
#include "claray/query.hpp"
#include "claray/shared/rng.h"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

struct Place {
    const char* name;
    double offset, scale;
    bool flat;  // triangles in planes y = const, where rounding has no say in y
};
void PrintTo(const Place& place, std::ostream* out) { *out << place.name; }

class SelfIntersection : public testing::TestWithParam<Place> {};

Mesh triangles_at(const Place& place, std::size_t count) {
    Mesh mesh = soup(count, 1.f, 42);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        glm::vec3& p = mesh.positions[i];
        p = glm::vec3(glm::dvec3(p) * place.scale +
                      glm::dvec3(place.offset, 0.37 * place.offset, -0.71 * place.offset));
        if (place.flat) p.y = 0.f;
    }
    return mesh;
}

TEST_P(SelfIntersection, NoRayHitsTheTriangleThatItLeaves) {
    const std::uint32_t triangles = 2000, rays_each = 256, count = triangles * rays_each;
    const Mesh mesh = triangles_at(GetParam(), triangles);
    Kernel leave = compile_kernel(device(), R"(
        #include "claray/shared/rng.h"
        #include "shade/surface.clh"
        /// Random points of all triangles, random viewers and directions on either side; `clearance` relative to the edges.
        kernel void leave(uint count, uint rays_each, global const float* positions, global const uint* indices,
                          global Ray* rays, global float* clearance) {
            const uint i = get_global_id(0);
            if (i >= count) return;
            const SamplePair a = independent_pair(i, 1u), b = independent_pair(i, 2u), c = independent_pair(i, 3u);
            const float root = sqrt(unit_float(a.x));
            const Hit hit = {0.0f, root * (1.0f - unit_float(a.y)), root * unit_float(a.y), i / rays_each, 0u};
            const float3 view = (float3)(unit_float(b.x), unit_float(b.y), unit_float(c.x)) - 0.5f;
            const Surface s = surface_at(hit, normalize(view), positions, indices, 0);
            const bool viewers_side = i & 1;
            float3 d = normalize((float3)(unit_float(c.x), unit_float(c.y), unit_float(a.x)) - 0.5f);
            if ((dot(d, s.geometric) > 0.0f) != viewers_side) d = -d;
            if (i % 8 == 0) d = normalize(d - 0.999f * dot(d, s.geometric) * s.geometric);  // grazing
            const float3 o = leave_surface(&s, viewers_side);
            const Ray ray = {o.x, o.y, o.z, 0.0f, d.x, d.y, d.z, INFINITY};
            rays[i] = ray;
            const float3 e = load3(positions, indices[3 * hit.primitive + 1]) - s.base;
            clearance[i] = s.clearance / length(e);
        })",
                                  "leave", {{"NORMALS", "0"}});
    const Bvh bvh = Bvh::build(device(), {&mesh, 1});
    Buffer<Ray> rays(device(), count);
    const Buffer<float> clearance(device(), count);
    leave.run({count, 64}, count, rays_each, bvh.triangles().positions, bvh.triangles().indices, rays, clearance);
    std::size_t self_hits = 0;
    const std::vector<Ray> all = rays.read();
    const std::vector<Hit> hits = closest_hit(bvh, all);
    for (std::uint32_t i = 0; i < count; ++i) self_hits += hits[i].primitive == i / rays_each;
    for (std::uint32_t t = 0; t < triangles; t += 20) {  // some triangles alone, so that no other hides them
        Mesh alone = mesh;
        alone.triangles = {mesh.triangles[t]};
        const std::span<const Ray> of_triangle(&all[std::size_t(t) * rays_each], rays_each);
        for (const Hit& hit : closest_hit(Bvh::build(device(), {&alone, 1}), of_triangle))
            self_hits += hit.primitive != CLARAY_MISS;
    }
    EXPECT_EQ(self_hits, 0u);
    std::vector<float> relative = clearance.read();
    std::nth_element(relative.begin(), relative.begin() + count / 2, relative.end());
    EXPECT_LT(relative[count / 2], 1e-3f) << "the median triangle's rays begin too far off";
}

INSTANTIATE_TEST_SUITE_P(Places, SelfIntersection,
                         testing::Values(Place{"AtTheOrigin", 0, 1, false}, Place{"FarAway", 1e3, 1, false},
                                         Place{"Tiny", 0, 1e-3, false}, Place{"Minute", 0, 1e-12, false},
                                         Place{"VeryFarAndLarge", 1e6, 100, false}, Place{"InOnePlane", 0, 1, true},
                                         Place{"InOnePlaneFarAway", 1e3, 1, true}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace claray::test
