// The contract of every BSDF: it conserves energy, is reciprocal, and is sampled with the density that it claims.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>

#include "tests/render/bsdf_harness.hpp"

namespace claray::test {
namespace {

// ---- the materials ----------------------------------------------------------------------------------------------

/// What is tested at a roughness, from outside and where it matters from inside.
struct Kind {
    const char* name;
    Material (*make)(float roughness);
    bool inside = false;
    bool complete = true;  ///< a white one reflects or transmits all light
};

Material plain_metal(float roughness) { return white(MaterialKind::metal, roughness); }
Material plain_glass(float roughness) { return white(MaterialKind::glass, roughness); }
Material dense_glass(float roughness) { return white(MaterialKind::glass, roughness, 2.2f); }
Material bubble(float roughness) { return white(MaterialKind::glass, roughness, 1 / 1.33f); }
Material plastic(float roughness) { return white(MaterialKind::principled, roughness); }
Material dense_plastic(float roughness) { return white(MaterialKind::principled, roughness, 2.4f); }

/// Shininess of about that roughness.
Material blinn_phong(float roughness) {
    Material m = white(MaterialKind::blinn_phong, roughness);
    m.albedo = glm::vec3(0.5f), m.specular = glm::vec3(0.5f);
    m.shininess = roughness > 0.f ? 2.f / std::pow(roughness, 4.f) - 2.f : 0.5f;
    return m;
}
Material only_highlight(float roughness) {
    Material m = blinn_phong(roughness);
    m.albedo = glm::vec3(0.f), m.specular = glm::vec3(1.f);
    return m;
}
/// Metal under a coat; its own roughness and the coat's differ.
Material coated_metal(float roughness) {
    Material m = white(MaterialKind::principled, roughness);
    m.metallic = 1.f, m.clearcoat = 1.f, m.clearcoat_roughness = 0.1f;
    return m;
}
Material under_rough_coat(float roughness) {
    Material m = coated_metal(0.35f);
    m.clearcoat_roughness = roughness;
    return m;
}
Material mixture(float roughness) {
    Material m = white(MaterialKind::principled, roughness, 1.4f);
    m.metallic = 0.4f, m.clearcoat = 0.6f, m.clearcoat_roughness = 0.2f, m.transmission = 0.5f;
    return m;
}

const Kind kinds[] = {
    {"Lambert", [](float r) { return white(MaterialKind::lambert, r); }},
    {"Mirror", [](float r) { return white(MaterialKind::mirror, r); }},
    {"Metal", plain_metal},
    {"Glass", plain_glass},
    {"GlassInside", plain_glass, true},
    {"DenseGlass", dense_glass},
    {"DenseGlassInside", dense_glass, true},
    {"Bubble", bubble},
    {"BubbleInside", bubble, true},
    {"BlinnPhong", blinn_phong, false, false},
    {"OnlyHighlight", only_highlight, false, false},
    {"Plastic", plastic},
    {"DensePlastic", dense_plastic},
    {"CoatedMetal", coated_metal},
    {"UnderRoughCoat", under_rough_coat},
    {"Mixture", mixture},
    {"MixtureInside", mixture, true},
};

/// Coated metal is what a principled material with these values always turns out to be at a hit.
bool turns_into(const Kind& kind, std::uint32_t what) {
    return what == CLARAY_COATED_METAL && (kind.make == coated_metal || kind.make == under_rough_coat);
}

TestedMaterial tested(const Kind& kind, float roughness) {
    TestedMaterial material(kind.make(roughness), kind.inside);
    if (turns_into(kind, CLARAY_COATED_METAL)) material.become(CLARAY_COATED_METAL);
    return material;
}

class Bsdf : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Materials, Bsdf, testing::ValuesIn(kinds), [](const auto& k) { return k.param.name; });
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

bool is_mixture(const Kind& kind) { return kind.make == mixture; }

// ---- energy -----------------------------------------------------------------------------------------------------

TEST_P(Bsdf, FurnaceStaysWhiteAtEveryRoughnessAndAngle) {
    std::vector<float> cosines;
    for (int i = 1; i <= 10; ++i) cosines.push_back(float(i) / 10);
    cosines.insert(cosines.end(), {0.01f, 0.02f, 0.05f});
    const auto count = std::uint32_t(cosines.size());
    for (const float roughness : {0.f, 0.04f, 0.07f, 0.15f, 0.29f, 0.5f, 0.75f, 1.f}) {
        const Buffer<float> out(device(), count);
        tested(GetParam(), roughness).run("albedo", count, count, 16384u, Buffer<float>(device(), cosines), out);
        const std::vector<float> albedos = out.read();
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_LE(albedos[i], 1.01f) << "roughness " << roughness << ", cosine " << cosines[i];
            if (!GetParam().complete) continue;
            EXPECT_NEAR(albedos[i], 1, 0.01) << "roughness " << roughness << ", cosine " << cosines[i];
        }
    }
}

// ---- reciprocity ------------------------------------------------------------------------------------------------

TEST_P(Bsdf, IsReciprocal) {
    if (is_mixture(GetParam())) GTEST_SKIP() << "every part of it is tested by itself";
    const std::uint32_t items = 1024, pairs = 1024;
    for (const float roughness : {0.05f, 0.35f, 1.f}) {
        const Buffer<float> worst(device(), items);
        const Buffer<std::uint32_t> compared(device(), items);
        tested(GetParam(), roughness).run("reciprocity", items, items, pairs, worst, compared);
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
    if (is_mixture(GetParam())) GTEST_SKIP() << "every part of it is tested by itself";
    for (const float roughness : {0.f, 0.1f, 0.5f, 1.f})
        for (const double theta : {0.0, 0.7, 1.5})
            for (const Sampled& s : tested(GetParam(), roughness).draw(at_angle(theta), 5000)) {
                if (!s.valid || s.pdf == 0) continue;
                ASSERT_NEAR(s.pdf / s.eval_pdf, 1, 1e-5) << s.x << " " << s.y << " " << s.z;
                ASSERT_NEAR(s.weight * s.pdf, s.eval_value, 1e-5 * s.eval_value) << s.x << " " << s.y << " " << s.z;
            }
}

/// The chance that chi-squared with so many degrees of freedom is larger (Wilson and Hilferty 1931).
double chance_of_more(double chi2, double degrees) {
    const double variance = 2 / (9 * degrees);
    const double z = (std::cbrt(chi2 / degrees) - (1 - variance)) / std::sqrt(variance);
    return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

/// Half of a grid over the sphere: equal turns around an axis, and rings that are narrow near it, as the lobe there is.
/// Only directions above the horizon, or only those below it, belong to it.
struct Grid {
    glm::dvec3 axis, side, other;
    bool above;
    std::vector<double> edges;  ///< angles from the axis
    static constexpr int turns = 20, rings = 24;

    Grid(const glm::dvec3& towards, double width) : axis(glm::normalize(towards)), above(axis.z > 0) {
        side = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        other = glm::cross(axis, side);
        const double stretch = std::clamp(2.2 - 1.15 * std::log(width), 0.1, 12.0);  // first rings: width / 4
        for (int i = 0; i <= rings; ++i) edges.push_back(pi * std::sinh(i * stretch / rings) / std::sinh(stretch));
    }
    static constexpr std::size_t size() { return std::size_t(rings) * turns; }
    /// The bin that a direction lies in.
    [[nodiscard]] std::size_t bin(const glm::dvec3& d) const {
        const double x = glm::dot(d, side), y = glm::dot(d, other);
        const double angle = std::atan2(std::hypot(x, y), glm::dot(d, axis));
        const auto ring = std::upper_bound(edges.begin() + 1, edges.end() - 1, angle) - edges.begin() - 1;
        const double turn = std::atan2(y, x) / (2 * pi) + 0.5;
        return std::size_t(ring) * turns + std::min(int(turn * turns), turns - 1);
    }
    [[nodiscard]] glm::dvec3 direction(double angle, double turn) const {
        const double phi = (turn - 0.5) * 2 * pi;
        return std::cos(angle) * axis + std::sin(angle) * (std::cos(phi) * side + std::sin(phi) * other);
    }
};

/// The integral of the density over each bin, by the midpoint rule.
std::vector<double> expected_shares(const TestedMaterial& material, const glm::vec3& outgoing, const Grid& grid) {
    const int fine = 32;
    std::vector<float> directions;
    std::vector<double> solid_angles;
    std::vector<std::size_t> bins;
    for (int ring = 0; ring < Grid::rings; ++ring)
        for (int turn = 0; turn < Grid::turns; ++turn)
            for (int i = 0; i < fine; ++i) {
                const double width = (grid.edges[ring + 1] - grid.edges[ring]) / fine;
                const double angle = grid.edges[ring] + (i + 0.5) * width;
                const double area = 2 * std::sin(angle) * std::sin(width / 2) * 2 * pi / Grid::turns / fine;
                for (int j = 0; j < fine; ++j) {
                    const glm::dvec3 d = grid.direction(angle, (turn + (j + 0.5) / fine) / Grid::turns);
                    if ((d.z > 0) != grid.above) continue;
                    directions.insert(directions.end(), {float(d.x), float(d.y), float(d.z)});
                    solid_angles.push_back(area);
                    bins.push_back(std::size_t(ring) * Grid::turns + turn);
                }
            }
    const std::vector<float> pdfs = material.evaluate(outgoing, directions).pdfs;
    std::vector<double> shares(Grid::size());
    for (std::size_t i = 0; i < pdfs.size(); ++i) shares[bins[i]] += pdfs[i] * solid_angles[i];
    return shares;
}

/// The chance that a sampler with the density it claims would be off by more. Samples that are not valid or come from a
/// delta function are in no bin.
double chance_of_samples(const TestedMaterial& material, const glm::vec3& outgoing, const std::vector<Grid>& grids) {
    const std::uint32_t count = 300'000;
    std::vector<std::vector<double>> observed(grids.size(), std::vector<double>(Grid::size()));
    double valid = 0;
    for (const Sampled& s : material.draw(outgoing, count)) {
        if (!s.valid || s.pdf == 0) continue;
        ++valid;
        for (std::size_t g = 0; g < grids.size(); ++g)
            if ((s.z > 0) == grids[g].above) ++observed[g][grids[g].bin({s.x, s.y, s.z})];
    }
    double chi2 = 0, degrees = 0, rare_observed = 0, rare_expected = 0, total = 0;
    const auto add = [&](double seen, double expected) {
        chi2 += (seen - expected) * (seen - expected) / expected, ++degrees;
    };
    for (std::size_t g = 0; g < grids.size(); ++g) {
        const std::vector<double> shares = expected_shares(material, outgoing, grids[g]);
        for (std::size_t i = 0; i < shares.size(); ++i) {
            const double expected = count * shares[i];
            total += shares[i];
            if (expected < 20)
                rare_observed += observed[g][i], rare_expected += expected;
            else
                add(observed[g][i], expected);
        }
    }
    if (rare_expected >= 20) add(rare_observed, rare_expected);
    EXPECT_NEAR(total, valid / count, 5e-3) << "the density's integral and the share of samples with one";
    return degrees > 0 ? chance_of_more(chi2, degrees) : 1;
}

/// Grids around the directions of ideal reflection and refraction where a lobe is narrow, else around the normal.
std::vector<Grid> grids_for(const Kind& kind, float roughness, const glm::vec3& o) {
    const Material m = kind.make(roughness);
    double width = 1;
    for (const float r : {m.roughness, m.clearcoat > 0 ? m.clearcoat_roughness : 1.f})
        if (r > 0.03f) width = std::min(width, double(r) * r);
    const double eta = kind.inside ? 1 / m.ior : m.ior, below = 1 - (1 - o.z * o.z) / (eta * eta);
    const bool narrow = width < 0.1;
    std::vector<Grid> grids = {Grid(narrow ? glm::dvec3(-o.x, -o.y, o.z) : glm::dvec3(0, 0, 1), narrow ? width : 1)};
    if (m.kind == MaterialKind::glass) {
        const bool refracted = narrow && below > 0;
        const glm::dvec3 through(-o.x / eta, -o.y / eta, -std::sqrt(std::max(below, 0.0)));
        grids.emplace_back(refracted ? through : glm::dvec3(0, 0, -1), refracted ? width * std::abs(eta - 1) / 2 : 1);
    }
    return grids;
}

const float tested_roughness[] = {0.f, 0.15f, 0.4f, 0.7f, 1.f};
const double tested_angles[] = {0.05, 0.8, 1.4};

/// Chi-squared at p = 0.01 for all tests together (Sidak 1967).
TEST_P(Bsdf, DirectionsFollowTheDensity) {
    if (is_mixture(GetParam())) GTEST_SKIP() << "every part of it is tested by itself";
    const double tests = double(std::size(kinds) * std::size(tested_roughness) * std::size(tested_angles));
    const double significance = 1 - std::pow(1 - 0.01, 1 / tests);
    for (const float roughness : tested_roughness)
        for (const double angle : tested_angles) {
            const glm::vec3 o = at_angle(angle);
            const TestedMaterial material = tested(GetParam(), roughness);
            EXPECT_GT(chance_of_samples(material, o, grids_for(GetParam(), roughness, o)), significance)
                << "roughness " << roughness << ", angle " << angle;
        }
}

// ---- parts ------------------------------------------------------------------------------------------------------

TEST(Principled, IsAMixtureInProportion) {
    const Material m = mixture(0.5f);
    const std::uint32_t count = 100'000;
    const Buffer<std::uint32_t> kinds_of(device(), count);
    const Buffer<float> roughness(device(), count);
    TestedMaterial(m).run("resolve", count, count, kinds_of, roughness);
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
    EXPECT_NEAR(share(CLARAY_PRINCIPLED, 0.2f), 0.6 * 0.6 * 0.5, 1e-3);
    EXPECT_NEAR(share(CLARAY_PRINCIPLED, 0.5f), 0.4 * 0.6 * 0.5, 1e-3);
}

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
    bsdf_kernel("fresnel").run({count, 64}, count, Buffer<float>(device(), cosines), Buffer<float>(device(), etas),
                               out);
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
    bsdf_kernel("density").run({count, 64}, count, Buffer<float>(device(), angles), Buffer<float>(device(), alphas),
                               out);
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
