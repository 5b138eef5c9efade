#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "claray/program.hpp"
#include "claray/shared/rng.h"
#include "claray/shared/scene.h"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

constexpr double pi = std::numbers::pi;

struct Sampled {
    float x, y, z, weight, pdf, eval_value, eval_pdf;
    std::uint32_t valid;
};

const char* const source = R"(
    #include "claray/shared/rng.h"
    #include "shade/bsdf.clh"
    typedef struct Sampled { float x, y, z, weight, pdf, eval_value, eval_pdf; uint valid; } Sampled;

    kernel void sample(MaterialData material, float ox, float oy, float oz, uint count, global Sampled* out) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        const SamplePair words = independent_pair(i, 4321u);
        const float3 outgoing = (float3)(ox, oy, oz);
        BsdfSample s;
        Sampled r = {0, 0, 0, 0, 0, 0, 0, 0};
        r.valid = sample_bsdf(&material, outgoing, false, (float2)(unit_float(words.x), unit_float(words.y)), &s);
        if (r.valid) {
            r.x = s.incoming.x, r.y = s.incoming.y, r.z = s.incoming.z;
            r.weight = s.weight.x, r.pdf = s.pdf;
            r.eval_value = eval_bsdf(&material, outgoing, s.incoming, &r.eval_pdf).x;
        }
        out[i] = r;
    }
    /// eval at directions (x, y, z); the values divided by |cos|, and the density.
    kernel void eval(MaterialData material, float ox, float oy, float oz, uint count, global const float* directions,
                     global float* values, global float* pdfs) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        const float3 incoming = vload3(i, directions);
        float pdf;
        values[i] = eval_bsdf(&material, (float3)(ox, oy, oz), incoming, &pdf).x / fabs(incoming.z);
        pdfs[i] = pdf;
    }
    kernel void fresnel(uint count, global const float* cosines, global const float* etas, global float* out) {
        const uint i = get_global_id(0);
        float beyond;
        if (i < count) out[i] = fresnel_dielectric(cosines[i], etas[i], &beyond);
    }
    kernel void density(uint count, global const float* angles, global const float* alphas, global float* out) {
        const uint i = get_global_id(0);
        if (i < count) out[i] = ggx_d((float3)(sin(angles[i]), 0.0f, cos(angles[i])), alphas[i]);
    }
)";

MaterialData material_data(std::uint32_t kind, float roughness = 0.f, float ior = 1.5f) {
    return {1.f, 1.f, 1.f, kind, 0.f, 0.f, 0.f, roughness, ior, 0.f};
}

struct Direction {
    float x, y, z;
};
Direction at_angle(double theta, double phi = 0.3) {
    return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)), float(std::cos(theta))};
}

std::vector<Sampled> draw(const MaterialData& material, Direction o, std::uint32_t count) {
    const Buffer<Sampled> out(device(), count);
    compile_kernel(device(), source, "sample").run({count, 64}, material, o.x, o.y, o.z, count, out);
    return out.read();
}

struct Evaluated {
    std::vector<float> values, pdfs;
};
Evaluated evaluate(const MaterialData& material, Direction o, const std::vector<float>& directions) {
    const auto count = std::uint32_t(directions.size() / 3);
    const Buffer<float> values(device(), count), pdfs(device(), count);
    compile_kernel(device(), source, "eval")
        .run({count, 64}, material, o.x, o.y, o.z, count, Buffer<float>(device(), directions), values, pdfs);
    return {values.read(), pdfs.read()};
}

struct Case {
    const char* name;
    MaterialData material;
    double theta;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Bsdf : public testing::TestWithParam<Case> {};

TEST_P(Bsdf, SampledWeightAndDensityAgreeWithEval) {
    std::size_t checked = 0;
    for (const Sampled& s : draw(GetParam().material, at_angle(GetParam().theta), 100'000)) {
        if (!s.valid || s.z < 1e-3f) continue;  // at the horizon a rounded cosine decides
        ++checked;
        ASSERT_NEAR(s.pdf / s.eval_pdf, 1, 5e-3) << s.x << " " << s.y << " " << s.z;
        ASSERT_NEAR(s.weight * s.pdf / s.eval_value, 1, 5e-3) << s.x << " " << s.y << " " << s.z;
        ASSERT_LE(s.weight, 1.0001f);
    }
    EXPECT_GT(checked, 30'000u);
}

/// Chi-squared of a histogram over (cos theta, phi) against the integral of the density over each bin.
TEST_P(Bsdf, DirectionsFollowTheDensity) {
    const Direction outgoing = at_angle(GetParam().theta);
    const int rows = 20, columns = 20, fine = 24;
    const std::uint32_t count = 1'000'000;
    std::vector<double> observed(rows * columns), expected(rows * columns);
    for (const Sampled& s : draw(GetParam().material, outgoing, count)) {
        if (!s.valid) continue;
        const int row = std::min(int(s.z * rows), rows - 1);
        const double turn = std::atan2(s.y, s.x) / (2 * pi) + 0.5;
        ++observed[row * columns + std::min(int(turn * columns), columns - 1)];
    }
    std::vector<float> directions;
    for (int i = 0; i < rows * fine; ++i)
        for (int j = 0; j < columns * fine; ++j) {
            const double z = (i + 0.5) / (rows * fine), phi = ((j + 0.5) / (columns * fine) - 0.5) * 2 * pi;
            for (const double v : {std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z})
                directions.push_back(float(v));
        }
    const Evaluated eval = evaluate(GetParam().material, outgoing, directions);
    for (int i = 0; i < rows * fine; ++i)
        for (int j = 0; j < columns * fine; ++j)
            expected[i / fine * columns + j / fine] +=
                double(count) * eval.pdfs[i * columns * fine + j] * 2 * pi / (rows * fine) / (columns * fine);
    double chi2 = 0, degrees = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i] < 5) continue;
        chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
        ++degrees;
    }
    ASSERT_GT(degrees, 20);
    EXPECT_LT(chi2, degrees + 5 * std::sqrt(2 * degrees));
}

TEST_P(Bsdf, IsReciprocal) {
    for (int i = 0; i < 50; ++i) {
        const Direction a = at_angle(GetParam().theta), b = at_angle(1.5 * (i + 0.5) / 50, 0.7 * i);
        const float forward = evaluate(GetParam().material, a, {b.x, b.y, b.z}).values[0];
        const float backward = evaluate(GetParam().material, b, {a.x, a.y, a.z}).values[0];
        if (forward > 0) {
            EXPECT_NEAR(forward / backward, 1, 1e-5) << i;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Materials, Bsdf,
                         testing::Values(Case{"LambertSteep", material_data(CLARAY_LAMBERT), 0.4},
                                         Case{"LambertGrazing", material_data(CLARAY_LAMBERT), 1.4},
                                         Case{"MetalRoughSteep", material_data(CLARAY_METAL, 1.f), 0.3},
                                         Case{"MetalRoughGrazing", material_data(CLARAY_METAL, 1.f), 1.4},
                                         Case{"MetalMedium", material_data(CLARAY_METAL, 0.7f), 0.9},
                                         Case{"MetalMediumNormal", material_data(CLARAY_METAL, 0.6f), 0.0},
                                         Case{"MetalGlossy", material_data(CLARAY_METAL, 0.45f), 1.0}),
                         [](const auto& c) { return c.param.name; });

/// Fresnel's equations in float64 complex arithmetic, which needs no case for total reflection.
double fresnel_reference(double cosine, double eta) {
    const std::complex<double> t = std::sqrt(std::complex<double>(1 - (1 - cosine * cosine) / (eta * eta)));
    const std::complex<double> s = (cosine - eta * t) / (cosine + eta * t), p = (eta * cosine - t) / (eta * cosine + t);
    return 0.5 * (std::norm(s) + std::norm(p));
}

TEST(Fresnel, EqualsFloat64AndNeverLeavesItsRange) {
    std::vector<float> cosines, etas;
    for (const float eta : {1.f / 2.4f, 1 / 1.5f, 0.99999f, 1.f, 1.0000001f, 1.001f, 1.33f, 1.5f, 2.4f})
        for (int i = 0; i <= 1000; ++i) cosines.push_back(i == 0 ? 0.f : float(i) / 1000), etas.push_back(eta);
    const auto count = std::uint32_t(cosines.size());
    const Buffer<float> out(device(), count);
    compile_kernel(device(), source, "fresnel")
        .run({count, 64}, count, Buffer<float>(device(), cosines), Buffer<float>(device(), etas), out);
    const std::vector<float> reflectances = out.read();
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_GE(reflectances[i], 0.f);
        ASSERT_LE(reflectances[i], 1.f);
        const double expected = etas[i] == 1.f ? 0 : fresnel_reference(cosines[i], etas[i]);
        ASSERT_NEAR(reflectances[i], expected, 2e-4) << "cosine " << cosines[i] << ", eta " << etas[i];
    }
}

TEST(Ggx, DensityIsExactForNarrowLobes) {
    std::vector<float> angles, alphas;
    for (const float alpha : {1e-4f, 1e-3f, 0.01f, 0.1f, 0.5f, 1.f})
        for (int i = 0; i < 500; ++i)
            angles.push_back(std::min(alpha * 0.02f * float(i), 1.5f)), alphas.push_back(alpha);
    const auto count = std::uint32_t(angles.size());
    const Buffer<float> out(device(), count);
    compile_kernel(device(), source, "density")
        .run({count, 64}, count, Buffer<float>(device(), angles), Buffer<float>(device(), alphas), out);
    const std::vector<float> densities = out.read();
    for (std::size_t i = 0; i < count; ++i) {
        const double alpha = alphas[i], c = std::cos(double(angles[i])), s = std::sin(double(angles[i]));
        const double denominator = alpha * alpha * c * c + s * s;
        EXPECT_NEAR(densities[i] / (alpha * alpha / (pi * denominator * denominator)), 1, 1e-6)
            << "alpha " << alpha << ", angle " << angles[i];
    }
}

}  // namespace
}  // namespace claray::test
