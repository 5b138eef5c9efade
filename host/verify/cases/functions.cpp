// The functions of which images consist, against float64. They rely on divisions and square roots that are rounded as
// IEEE 754 says, which OpenCL lets a driver leave out.
#include <cmath>
#include <numbers>

#include "claray/program.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/committed.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

constexpr double least = 0x1p-126;  // smaller results may be flushed to 0

/// The error in units in the last place of the expected value, as a float32. Infinities and NaN must be equal.
double error_in_ulp(float found, double expected) {
    if (std::isnan(expected)) return std::isnan(found) ? 0 : 1e9;
    if (std::isinf(expected) || std::abs(expected) >= 0x1.ffffffp127) return std::isinf(found) ? 0 : 1e9;
    if (std::abs(expected) < least) return std::abs(double(found)) <= least ? 0 : 1e9;
    return std::abs(found - expected) / std::ldexp(1.0, std::ilogb(expected) - 23);
}

double around(double turns, bool sine) {
    const double angle = 2 * std::numbers::pi * (std::abs(turns) - std::floor(std::abs(turns)));
    return sine ? std::sin(angle) : std::cos(angle);
}

struct Function {
    const char* name;
    double (*expected)(double x, double y);
    double bar;             // in ulp
    bool absolute = false;  // 1 ulp is 2^-24
};

/// In the order of kernels/verify/functions.cl. 0.5: rounded correctly.
constexpr Function functions[] = {
    {"x / y", [](double x, double y) { return x / y; }, 0.5},
    {"sqrt", [](double x, double) { return std::sqrt(std::abs(x)); }, 0.5},
    {"exponential", [](double x, double) { return std::exp(x); }, 1},
    {"exponential_minus_1", [](double x, double) { return std::expm1(x); }, 3},
    {"logarithm", [](double x, double) { return std::log(std::abs(x)); }, 1},
    {"logarithm_2", [](double x, double) { return std::log2(std::max(std::abs(x), least)); }, 2},
    {"logarithm_of_1_plus", [](double x, double) { return std::log1p(x); }, 4},
    {"half_turns_of", [](double x, double y) { return std::atan2(y, x) / std::numbers::pi; }, 4},
    {"angle_of_cosine", [](double x, double) { return std::acos(std::min(std::abs(x), 1.0)); }, 5},
    {"cosine of turns", [](double x, double) { return around(x, false); }, 2, true},
    {"sine of turns", [](double x, double) { return around(x, true); }, 2, true},
    {"reciprocal_root", [](double x, double) { return 1 / std::sqrt(std::abs(x)); }, 1.5},
};
constexpr std::size_t function_count = std::size(functions);

/// Of all exponents, and of those near 1.
std::vector<float> pairs_of_floats(Run& run) {
    Random random(90 + (run.full() ? run.seed() : 1));  // the quick ones have a committed hash
    std::vector<float> pairs = {0.f, 1.f, 1.f, 0.f, -1.f, 0.f, 0.f, -1.f, 1.f, 1.f, -1.f, -1.f, 88.7f, 2.f, -87.f, 2.f};
    while (pairs.size() < 2 * run.count(2'000'000u, 8'000'000u)) {
        const int range = pairs.size() % 4 < 2 ? 100 : 7;
        for (int k = 0; k < 2; ++k)
            pairs.push_back(std::ldexp((1.f + random.uniform()) * (random.below(2) ? 1.f : -1.f),
                                       int(random.below(2 * std::uint32_t(range))) - range));
    }
    return pairs;
}

void functions_of_numbers(Run& run) {
    const std::vector<float> pairs = pairs_of_floats(run);
    const auto count = std::uint32_t(pairs.size() / 2);
    const Buffer<float> out(run.device(), function_count * count);
    load_kernel(run.device(), "verify/functions.cl", "evaluate_functions")
        .run({count, 64}, count, arg("pairs", Buffer<float>(run.device(), pairs)), arg("out", out));
    const std::vector<float> found = out.read();
    for (std::size_t k = 0; k < function_count; ++k) {
        const Function& of = functions[k];
        double worst = 0;
        std::size_t at = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double expected = of.expected(pairs[2 * i], pairs[2 * i + 1]);
            const float value = found[function_count * i + k];
            const double error = of.absolute ? std::abs(value - expected) * 0x1p24 : error_in_ulp(value, expected);
            if (error > worst) worst = error, at = i;
        }
        if (worst > of.bar + 1e-6)
            run.failure(printed("%s of %a and %a is %a", of.name, double(pairs[2 * at]), double(pairs[2 * at + 1]),
                                double(found[function_count * at + k])));
        run.check(of.name, count, worst, of.bar + 1e-6, of.absolute ? "* 2^-24" : "ulp");
    }
    if (run.full()) return;
    std::vector<float> defined = found;
    for (float& value : defined)
        if (!(std::abs(value) >= least)) value = std::isnan(value) ? 1e-30f : 0.f;
    Committed bits(run);
    bits.compare("functions", defined);
    bits.check("values of functions");
}

/// Vectors are rounded as numbers are.
void functions_of_vectors(Run& run) {
    const std::vector<float> pairs = pairs_of_floats(run);
    std::vector<float> x, y;
    for (std::size_t i = 0; i + 32 <= pairs.size(); i += 2) x.push_back(pairs[i]), y.push_back(pairs[i + 1]);
    x.resize(x.size() / 16 * 16), y.resize(x.size());
    const auto count = std::uint32_t(x.size() / 16);
    const Buffer<float> quotients(run.device(), x.size()), roots(run.device(), x.size());
    load_kernel(run.device(), "verify/functions.cl", "evaluate_vectors")
        .run({count, 64}, count, arg("x", Buffer<float>(run.device(), x)), arg("y", Buffer<float>(run.device(), y)),
             arg("quotients", quotients), arg("roots", roots));
    const std::vector<float> divided = quotients.read(), rooted = roots.read();
    Tally wrong[2];
    for (std::size_t i = 0; i < x.size(); ++i) {
        wrong[0].add(error_in_ulp(divided[i], double(x[i]) / y[i]) <= 0.5 + 1e-6);
        wrong[1].add(error_in_ulp(rooted[i], std::sqrt(std::abs(double(x[i])))) <= 0.5 + 1e-6);
    }
    run.check("quotients of vectors", wrong[0], "wrongly rounded");
    run.check("roots of vectors", wrong[1], "wrongly rounded");
}

void all_functions(Run& run) {
    functions_of_numbers(run);
    functions_of_vectors(run);
}

}  // namespace

Cases function_cases() {
    return {{{"functions", "device",
              "Divisions, roots, exponentials and angles have their bounds, and the same bits as on other devices"},
             all_functions}};
}

}  // namespace claray::verify
