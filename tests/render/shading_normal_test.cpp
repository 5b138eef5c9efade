// Shading normals that disagree with their triangle, up to lying in its plane or behind it.
#include <gtest/gtest.h>

#include "claray/program.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// Whatever the vertex normals: the shading normal sees the viewer, and a mirror of it reflects away from the surface.
TEST(ShadingNormal, SeesTheViewerAndReflectsAwayFromTheSurface) {
    const std::uint32_t count = 100'000;
    Kernel kernel = compile_kernel(device(), R"(
        #include "claray/shared/rng.h"
        #include "shade/surface.clh"
        kernel void check(uint count, global float* cosines) {
            const uint i = get_global_id(0);
            if (i >= count) return;
            const SamplePair a = independent_pair(i, 1u), b = independent_pair(i, 2u);
            const float3 geometric = (float3)(0.0f, 1.0f, 0.0f);
            const float2 n = cosine_and_sine(unit_float(a.x)), o = cosine_and_sine(unit_float(b.x));
            const float up = unit_float(a.y), height = 0.001f + 0.999f * unit_float(b.y) * unit_float(b.y);
            const float3 shading = (float3)(sqrt(1.0f - up * up) * n.x, up, sqrt(1.0f - up * up) * n.y);
            const float3 outgoing = (float3)(sqrt(1.0f - height * height) * o.x, height, sqrt(1.0f - height * height) * o.y);
            const float3 bent = bend_normal(shading, geometric, outgoing);
            cosines[3 * i] = dot(bent, outgoing);
            cosines[3 * i + 1] = dot(2.0f * dot(bent, outgoing) * bent - outgoing, geometric);
            cosines[3 * i + 2] = length(bent);
        })",
                                   "check");
    const Buffer<float> cosines(device(), 3 * std::size_t(count));
    kernel.run({count, 64}, count, cosines);
    const std::vector<float> result = cosines.read();
    for (std::uint32_t i = 0; i < count; ++i) {
        ASSERT_GT(result[3 * i], 0.f) << i;
        ASSERT_GT(result[3 * i + 1], 0.f) << i;
        ASSERT_NEAR(result[3 * i + 2], 1.f, 1e-5f) << i;
    }
}

}  // namespace
}  // namespace claray::test
