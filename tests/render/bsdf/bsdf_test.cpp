// The contract of every BSDF: it conserves energy, is reciprocal, and is sampled with the density that it claims.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/verify/cases/rendering/bsdf.hpp"
#include "tests/support/device.hpp"

namespace claray::verify {

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

}  // namespace claray::verify

namespace claray::test {
namespace {

using verify::at_angle;
using verify::Kind;
using verify::Sampled;
using verify::TestedMaterial;

TestedMaterial tested(const Kind& kind, float roughness) { return verify::tested(device(), kind, roughness); }

class Bsdf : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Materials, Bsdf, testing::ValuesIn(verify::bsdf_kinds()),
                         [](const auto& k) { return k.param.name; });

/// Unlit surfaces scatter nothing.
TEST(Bsdfs, AreAllTried) {
    const auto& tried = verify::bsdf_kinds();
    for (const MaterialKindRow& row : material_kinds)
        EXPECT_TRUE(
            row.kind == MaterialKind::unlit ||
            std::any_of(tried.begin(), tried.end(), [&](const Kind& k) { return k.make(0.5f).kind == row.kind; }))
            << row.name << " is missing in host/verify/cases/rendering/bsdf.cpp";
}

// ---- energy -----------------------------------------------------------------------------------------------------

TEST_P(Bsdf, FurnaceStaysWhiteAtEveryRoughnessAndAngle) {
    std::vector<float> cosines;
    for (int i = 1; i <= 10; ++i) cosines.push_back(float(i) / 10);
    cosines.insert(cosines.end(), {0.01f, 0.02f, 0.05f});
    const auto count = std::uint32_t(cosines.size());
    for (const float roughness : {0.f, 0.04f, 0.07f, 0.15f, 0.29f, 0.5f, 0.75f, 1.f}) {
        const Buffer<float> out(device(), count);
        tested(GetParam(), roughness)
            .run("albedo", "albedo", count, count, 4096u, arg("cosines", Buffer<float>(device(), cosines)),
                 arg("out", out));
        const std::vector<float> albedos = out.read();
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_LE(albedos[i], 1.01f) << "roughness " << roughness << ", cosine " << cosines[i];
            if (GetParam().complete) {
                EXPECT_GE(albedos[i], 0.99f) << "roughness " << roughness << ", cosine " << cosines[i];
            }
        }
    }
}

// ---- reciprocity ------------------------------------------------------------------------------------------------

TEST_P(Bsdf, IsReciprocal) {
    if (GetParam().mixed) GTEST_SKIP() << "every part of it is tested by itself";
    const std::uint32_t items = 1024, pairs = 256;
    for (const float roughness : {0.05f, 0.35f, 1.f}) {
        const Buffer<float> worst(device(), items);
        const Buffer<std::uint32_t> compared(device(), items);
        tested(GetParam(), roughness)
            .run("reciprocity", "reciprocity", items, items, pairs, arg("worst", worst), compared);
        const std::vector<float> errors = worst.read();
        const std::vector<std::uint32_t> counts = compared.read();
        EXPECT_LE(*std::max_element(errors.begin(), errors.end()), 1e-5f) << "roughness " << roughness;
        std::uint64_t total = 0;
        for (const std::uint32_t c : counts) total += c;
        if (GetParam().make(1.f).kind != MaterialKind::mirror) {
            EXPECT_GT(total, items * pairs / 10) << "roughness " << roughness;
        }
    }
}

// ---- sampling ---------------------------------------------------------------------------------------------------

TEST_P(Bsdf, SampledWeightAndDensityAgreeWithEval) {
    if (GetParam().mixed) GTEST_SKIP() << "every part of it is tested by itself";
    for (const float roughness : {0.f, 0.1f, 0.5f, 1.f})
        for (const double theta : {0.0, 0.7, 1.5})
            for (const Sampled& s : tested(GetParam(), roughness).draw(at_angle(theta), 5000)) {
                if (!s.valid || s.pdf == 0) continue;
                ASSERT_NEAR(s.pdf / s.eval_pdf, 1, 1e-5) << s.x << " " << s.y << " " << s.z;
                ASSERT_NEAR(s.weight * s.pdf, s.eval_value, 1e-5 * s.eval_value) << s.x << " " << s.y << " " << s.z;
            }
}

const float tested_roughness[] = {0.f, 0.15f, 0.4f, 0.7f, 1.f};
const double tested_angles[] = {0.05, 0.8, 1.4};

/// Chi-squared at p = 0.01 for all tests together (Sidak 1967).
TEST_P(Bsdf, DirectionsFollowTheDensity) {
    if (GetParam().mixed) GTEST_SKIP() << "every part of it is tested by itself";
    const double tests = double(verify::bsdf_kinds().size() * std::size(tested_roughness) * std::size(tested_angles));
    const double significance = 1 - std::pow(1 - 0.01, 1 / tests);
    for (const float roughness : tested_roughness)
        for (const double angle : tested_angles) {
            const auto [chance, excess] =
                verify::agreement_of_samples(device(), GetParam(), roughness, at_angle(angle), 100'000);
            EXPECT_LT(excess, 5e-3) << "the density's integral and the share of samples with one";
            EXPECT_GT(chance, significance) << "roughness " << roughness << ", angle " << angle;
        }
}

/// A lobe that is smooth across the tangent ends at the horizon over a whole row of cells.
TEST(Bsdfs, StretchedLobesFollowTheirDensityUpToTheHorizon) {
    const auto& kinds = verify::bsdf_kinds();
    const auto brushed =
        std::find_if(kinds.begin(), kinds.end(), [](const Kind& k) { return k.name == std::string("BrushedMetal"); });
    EXPECT_GT(verify::agreement_of_samples(device(), *brushed, 0.f, at_angle(0.05), 1'000'000).chance, 1e-4);
}

// ---- parts ------------------------------------------------------------------------------------------------------

TEST(Principled, IsAMixtureInProportion) {
    const auto& kinds = verify::bsdf_kinds();
    const Kind& mixed = *std::find_if(kinds.begin(), kinds.end(), [](const Kind& k) { return k.mixed; });
    const Material m = mixed.make(0.5f);
    const std::uint32_t count = 100'000;
    const Buffer<std::uint32_t> kinds_of(device(), count);
    const Buffer<float> roughness(device(), count);
    TestedMaterial(device(), m).run("samples", "resolve", count, count, kinds_of, arg("roughness", roughness));
    const std::vector<std::uint32_t> found = kinds_of.read();
    const std::vector<float> rough = roughness.read();
    const auto share = [&](std::uint32_t kind, float r) {
        double n = 0;
        for (std::size_t i = 0; i < count; ++i) n += found[i] == kind && rough[i] == r;
        return n / count;
    };
    EXPECT_NEAR(share(CLARAY_COATED_METAL, 0.5f), 0.6 * 0.4, 1e-3);
    EXPECT_NEAR(share(CLARAY_METAL, 0.5f), 0.4 * 0.4, 1e-3);
    EXPECT_NEAR(share(CLARAY_GLASS, 0.2f), 0.6 * 0.6 * 0.5, 1e-3);
    EXPECT_NEAR(share(CLARAY_GLASS, 0.5f), 0.4 * 0.6 * 0.5, 1e-3);
    EXPECT_NEAR(share(CLARAY_PRINCIPLED, 0.5f), 0.6 * 0.5, 1e-3);  // whether it is coated or not
}

}  // namespace
}  // namespace claray::test
