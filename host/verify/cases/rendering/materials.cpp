// Materials where float32 and careless formulas fail: narrow lobes, total reflection, grazing angles, density and
// energy.
#include <algorithm>
#include <cmath>

#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"

namespace claray::verify {
namespace {

std::string named(const Kind& kind, float roughness) {
    return printed("%s of roughness %g", kind.name, double(roughness));
}

/// Every second kind without mixtures, if there is no time for all.
std::vector<Kind> kinds_of(const Run& run) {
    std::vector<Kind> kinds;
    for (std::size_t i = 0; i < bsdf_kinds().size(); ++i)
        if (run.full() || i % 2 == 0) kinds.push_back(bsdf_kinds()[i]);
    return kinds;
}

double reference_density(double alpha, double angle) {
    const double c = std::cos(angle), s = std::sin(angle), denominator = alpha * alpha * c * c + s * s;
    return alpha * alpha / (pi * denominator * denominator);
}

void ggx_density(Run& run) {
    std::vector<float> angles, alphas;
    const int steps = run.count(500, 50'000);
    const float tested_alphas[] = {1e-4f, 1e-3f, 0.01f, 0.1f, 0.5f, 1.f};
    for (const float alpha : tested_alphas)
        for (int i = 0; i < steps; ++i) {
            angles.push_back(std::min(alpha * 10.f * float(i) / float(steps), 1.5f));
            alphas.push_back(alpha);
        }
    const auto count = std::uint32_t(angles.size());
    const Buffer<float> out(run.device(), count);
    load_kernel(run.device(), "verify/microfacets.cl", "density")
        .run({count, 64}, count, arg("angles", Buffer<float>(run.device(), angles)),
             arg("alphas", Buffer<float>(run.device(), alphas)), arg("out", out));
    const auto found = out.read();
    for (std::size_t a = 0; a < std::size(tested_alphas); ++a) {
        double worst = 0;
        std::size_t at = 0;
        std::vector<double> x, y;
        for (std::size_t i = a * std::size_t(steps); i < (a + 1) * std::size_t(steps); ++i) {
            const double error = std::abs(found[i] / reference_density(alphas[i], angles[i]) - 1);
            x.push_back(angles[i]), y.push_back(error);
            if (!(error <= worst)) worst = error, at = i;
        }
        run.check(printed("relative error of D, alpha %g", double(tested_alphas[a])), std::uint64_t(steps), worst, 1e-6,
                  "");
        if (worst <= 1e-6) continue;
        run.failure(
            printed("D is %a at angle %a, alpha %a", double(found[at]), double(angles[at]), double(alphas[at])));
        run.picture(picture_of_curves({{x, y, 0xc00000u}}, "relative error of D over the angle"));
    }
}

/// Albedo of GGX's single scattering without Fresnel: at normal incidence and alpha 1 it is 1 - ln 2.
void ggx_energy(Run& run) {
    const double reference = single_scattering_albedo(1, 1);
    run.check("reference against 1 - ln 2", 1, std::abs(reference - (1 - std::log(2.0))), 1e-3, "");
    const std::vector<float> cosines = {1.f, 0.6f, 0.2f}, alphas = {1.f, 0.5f, 0.3f};  // where the rule has converged
    std::vector<float> c, a;
    for (const float cosine : cosines)
        for (const float alpha : alphas) c.push_back(cosine), a.push_back(alpha);
    const auto count = std::uint32_t(c.size());
    const std::uint32_t samples = run.count(1u << 16, 1u << 20);
    const Buffer<float> out(run.device(), count);
    load_kernel(run.device(), "verify/microfacets.cl", "single_scattering")
        .run({count, 1}, count, samples, arg("cosines", Buffer<float>(run.device(), c)),
             arg("alphas", Buffer<float>(run.device(), a)), arg("out", out));
    const auto found = out.read();
    double worst = 0;
    for (std::size_t i = 0; i < count; ++i)
        worst = std::max(worst, std::abs(found[i] - single_scattering_albedo(a[i], c[i])));
    run.check("light that is scattered once, against quadrature", std::uint64_t(count) * samples, worst, 1e-3, "");
}

void furnaces(Run& run) {
    std::vector<float> cosines = {0.01f, 0.05f, 0.2f, 0.6f, 1.f};
    if (run.full())
        for (int i = 1; i < 40; ++i) cosines.push_back(float(i) / 40);
    const auto count = std::uint32_t(cosines.size());
    const std::uint32_t samples = run.count(4096u, 65'536u);
    double most[2] = {}, off[2] = {};  // of all, of glass
    std::uint64_t tried[2] = {};
    for (const Kind& kind : bsdf_kinds()) {
        const bool glass = std::string(kind.name).find("lass") != std::string::npos;
        for (const float roughness : {0.f, 0.15f, 0.5f, 1.f}) {
            const Buffer<float> out(run.device(), count);
            tested(run.device(), kind, roughness)
                .run("albedo", "albedo", count, count, samples, arg("cosines", Buffer<float>(run.device(), cosines)),
                     arg("out", out));
            const Material material = kind.make(roughness);
            const bool bare = material.sheen == glm::vec3(0.f) && material.clearcoat == 0;
            const bool smooth_glass = glass && bare && roughness == 0;
            const std::vector<float> albedos = out.read();
            for (std::size_t i = 0; i < count; ++i) {
                const float albedo = albedos[i];
                const double error = kind.complete ? std::abs(double(albedo) - 1) : 0;
                if (!(error <= (smooth_glass ? 0.005 : 0.01)) || !(albedo <= 1.01f))
                    run.failure(named(kind, roughness) + " scatters " + std::to_string(albedo) + " at cosine " +
                                std::to_string(cosines[i]));
                most[0] = std::max(most[0], double(albedo)), off[smooth_glass] = std::max(off[smooth_glass], error);
                tried[smooth_glass] += samples;
            }
        }
    }
    run.check("albedo of white materials", tried[0] + tried[1], most[0], 1.01, "");
    run.check("distance of the furnace from 1", tried[0], off[0], 0.01, "");
    run.check("distance of the furnace from 1, smooth glass", tried[1], off[1], 0.005, "");
}

void fresnel(Run& run) {
    std::vector<float> cosines, etas;
    const int steps = run.count(1000, 1'000'000);
    for (const float eta : {1.f / 2.4f, 1 / 1.5f, 0.99999f, 1.f, 1.0000001f, 1.001f, 1.33f, 1.5f, 2.4f}) {
        for (int i = 0; i <= steps; ++i) cosines.push_back(float(i) / float(steps)), etas.push_back(eta);
        float critical = float(std::sqrt(std::max(0.0, 1 - double(eta) * eta)));  // where the curve is steepest
        for (int i = 0; i < 50; ++i) critical = std::nextafter(critical, 0.f);
        for (int i = 0; i < 100; ++i, critical = std::nextafter(critical, 1.f))
            cosines.push_back(critical), etas.push_back(eta);
    }
    const auto count = std::uint32_t(cosines.size());
    const Buffer<float> out(run.device(), count);
    load_kernel(run.device(), "verify/microfacets.cl", "fresnel")
        .run({count, 64}, count, arg("cosines", Buffer<float>(run.device(), cosines)),
             arg("etas", Buffer<float>(run.device(), etas)), arg("out", out));
    const auto found = out.read();
    double worst = 0;
    Tally outside;
    for (std::size_t i = 0; i < count; ++i) {
        outside.add(found[i] >= 0 && found[i] <= 1);
        const double expected = etas[i] == 1.f ? 0 : fresnel_reference(cosines[i], etas[i]);
        const double error = std::abs(found[i] - expected);
        if (error > 2e-4 && worst <= 2e-4)
            run.failure("F is " + std::to_string(found[i]) + " instead of " + std::to_string(expected) + " at cosine " +
                        std::to_string(cosines[i]) + ", eta " + std::to_string(etas[i]));
        if (!(error <= worst)) worst = error;
    }
    run.check("reflectances outside of 0..1", outside, "values");
    run.check("absolute error", count, worst, 2e-4, "");
}

void bsdf_reciprocity(Run& run) {
    const std::uint32_t items = 256, pairs = run.count(256u, 4096u);
    double worst = 0;
    std::uint64_t compared = 0;
    for (const Kind& kind : bsdf_kinds()) {
        if (kind.mixed) continue;
        for (const float roughness : {0.05f, 0.35f, 1.f}) {
            const Buffer<float> errors(run.device(), items);
            const Buffer<std::uint32_t> counts(run.device(), items);
            tested(run.device(), kind, roughness)
                .run("reciprocity", "reciprocity", items, items, pairs, arg("worst", errors), counts);
            for (const std::uint32_t c : counts.read()) compared += c;
            const auto all = errors.read();
            const double most = *std::max_element(all.begin(), all.end());
            if (!(most <= 1e-5))
                run.failure(named(kind, roughness) + ": f(i, o) and f(o, i) differ by " + std::to_string(most));
            worst = std::max(worst, most);
        }
    }
    run.check("relative difference of f(i, o) and f(o, i)", compared, worst, 1e-5, "");
}

/// Chi-squared at p = 0.01 for all tests together (Sidak 1967).
void bsdf_sampling(Run& run) {
    std::vector<float> roughness = {0.f, 0.4f};
    std::vector<double> angles = {0.8};
    if (run.full()) roughness = {0.f, 0.15f, 0.4f, 0.7f, 1.f}, angles = {0.05, 0.8, 1.4};
    const std::uint32_t samples = run.count(100'000u, 1'000'000u);
    double least = 1, excess = 0;
    int tests = 0;
    std::string worst;
    for (const Kind& kind : kinds_of(run)) {
        if (kind.mixed) continue;
        for (const float r : roughness)
            for (const double angle : angles) {
                const Agreement a =
                    agreement_of_samples(run.device(), kind, r, at_angle(angle), samples, std::uint32_t(run.seed()));
                if (!(a.chance >= least))
                    least = a.chance, worst = named(kind, r) + " at angle " + std::to_string(angle);
                excess = std::max(excess, a.excess), ++tests;
            }
    }
    const double significance = 1 - std::pow(1 - 0.01, 1.0 / tests);
    if (!(least >= significance))
        run.failure("the directions of " + worst + " do not follow the density: chance " + std::to_string(least));
    run.check("1 - least chance, chi-squared of " + std::to_string(tests) + " tests", std::uint64_t(tests) * samples,
              1 - least, 1 - significance, "");
    run.check("density's integral against the share of samples", std::uint64_t(tests) * samples, excess, 5e-3, "");
}

/// For any vertex normals the shading normal faces the viewer, and a mirror with it reflects away from the surface.
void shading_normals(Run& run) {
    const auto count = run.count(100'000u, 10'000'000u);
    const Buffer<float> cosines(run.device(), 3 * std::size_t(count));
    load_kernel(run.device(), "verify/shading_normals.cl", "shading_normals")
        .run({count, 64}, count, std::uint32_t(run.seed()), cosines);
    const auto found = cosines.read();
    Tally sees, reflects;
    double length = 0;
    for (std::size_t i = 0; i < count; ++i) {
        sees.add(found[3 * i] > 0), reflects.add(found[3 * i + 1] > 0);
        length = std::max(length, std::abs(double(found[3 * i + 2]) - 1));
    }
    run.check("shading normals turned from the viewer", sees, "normals");
    run.check("mirrors that reflect into the surface", reflects, "normals");
    run.check("lengths off 1", count, length, 1e-5, "");
}

}  // namespace

Cases material_cases() {
    return {
        {{"ggx-density", "materials", "Density of narrow GGX lobes, alpha down to 1e-4"}, ggx_density},
        {{"ggx-energy", "materials", "Single scattering of GGX equals quadrature; 1 - ln 2 at alpha 1"}, ggx_energy},
        {{"furnaces", "materials", "White materials scatter all light and not more, at every angle and roughness"},
         furnaces},
        {{"fresnel", "materials", "Fresnel equations up to total reflection and with nearly equal indices"}, fresnel},
        {{"bsdf-reciprocity", "materials", "f(i, o) = f(o, i)"}, bsdf_reciprocity},
        {{"bsdf-sampling", "materials", "Sampled directions follow the stated density: chi-squared"}, bsdf_sampling},
        {{"shading-normals", "materials", "Shading normals face the viewer and reflect away from the surface"},
         shading_normals},
    };
}

}  // namespace claray::verify
