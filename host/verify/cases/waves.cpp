// Water as a height field: the discrete wave equation against its closed forms.
#include <algorithm>
#include <cmath>

#include "claray/program.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

using Heights = std::vector<float>;

/// A square of side 1 with its rim at rest, stepped on the device.
class Water {
public:
    Water(const Run& run, unsigned side, double courant, const Heights& at_rest)
        : side_(side),
          courant_squared_(float(courant * courant)),
          step_(load_kernel(run.device(), "verify/wave_equation.cl", "step_wave")),
          now_(run.device(), at_rest),
          before_(run.device(), at_rest) {}

    void step() {
        step_.run({std::size_t(side_) * side_, 64}, arg("now", now_), arg("before", before_), side_, courant_squared_);
        std::swap(now_, before_);
    }
    [[nodiscard]] Heights heights() const { return now_.read(); }
    [[nodiscard]] Heights heights_before() const { return before_.read(); }

private:
    unsigned side_;
    float courant_squared_;
    Kernel step_;
    Buffer<float> now_, before_;
};

/// A standing wave with p and q half waves along the sides.
Heights standing_wave(unsigned side, int p, int q) {
    Heights heights(std::size_t(side) * side);
    for (unsigned y = 1; y + 1 < side; ++y)
        for (unsigned x = 1; x + 1 < side; ++x)
            heights[y * side + x] =
                float(std::sin(pi * p * x / double(side - 1)) * std::sin(pi * q * y / double(side - 1)));
    return heights;
}

/// What the scheme conserves exactly, up to a factor: the squared steps and, times C^2, the products of the slopes
/// before and after (Cohen 2002, "Higher-Order Numerical Methods for Transient Wave Equations", section 5.2).
double energy(unsigned side, double courant, const Heights& now, const Heights& before) {
    double moving = 0, bent = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        moving += (double(now[i]) - double(before[i])) * (double(now[i]) - double(before[i]));
        if (i % side + 1 < side)
            bent += (double(now[i + 1]) - double(now[i])) * (double(before[i + 1]) - double(before[i]));
        if (i + side < now.size())
            bent += (double(now[i + side]) - double(now[i])) * (double(before[i + side]) - double(before[i]));
    }
    return moving + courant * courant * bent;
}

/// The frequency of a standing wave as measured, over that of the continuous equation: a wave of frequency w satisfies
/// a(t + dt) + a(t - dt) = 2 cos(w dt) a(t).
double measured_frequency(const Run& run, unsigned side, double courant, int p, int q) {
    const Heights mode = standing_wave(side, p, q);
    Water water(run, side, courant, mode);
    std::vector<double> amplitudes;
    for (unsigned i = 0; i < 4 * side; ++i) {
        water.step();
        double sum = 0;
        const Heights heights = water.heights();
        for (std::size_t k = 0; k < mode.size(); ++k) sum += double(heights[k]) * double(mode[k]);
        amplitudes.push_back(sum);
    }
    double product = 0, square = 0;
    for (std::size_t i = 1; i + 1 < amplitudes.size(); ++i) {
        const double neighbours = amplitudes[i - 1] + amplitudes[i + 1] - 2 * amplitudes[i];
        product += amplitudes[i] * neighbours, square += amplitudes[i] * amplitudes[i];
    }
    const double half_angle = std::asin(std::sqrt(-product / square / 4));  // w dt / 2
    return 2 * half_angle / (pi * std::hypot(p, q) * courant / double(side - 1));
}

Heights rough_water(unsigned side, std::uint64_t seed) {
    Random random(seed);
    Heights heights(std::size_t(side) * side);
    for (unsigned y = 1; y + 1 < side; ++y)
        for (unsigned x = 1; x + 1 < side; ++x) heights[y * side + x] = random.uniform(-1.f, 1.f);
    return heights;
}

void step_on_host(unsigned side, float courant_squared, const Heights& now, Heights& before) {
    for (std::size_t y = 1; y + 1 < side; ++y)
        for (std::size_t x = 1; x + 1 < side; ++x) {
            const std::size_t i = y * side + x;
            const float laplacian = (now[i - 1] + now[i + 1]) + (now[i - side] + now[i + side]) - 4.0f * now[i];
            before[i] = std::fma(courant_squared, laplacian, 2.0f * now[i] - before[i]);
        }
}

double highest(const Heights& heights) {
    double most = 0;
    for (const float h : heights) most = std::isfinite(h) ? std::max(most, std::abs(double(h))) : INFINITY;
    return most;
}

/// Energy of rough water at the limit of Courant, Friedrichs and Lewy, and that it grows above the limit.
void check_stability(Run& run) {
    const unsigned side = 65, steps = run.count(1'000u, 20'000u);
    const double courant = std::sqrt(0.5) * 0.999;
    Water water(run, side, courant, rough_water(side, run.seed()));
    water.step();
    const double first = energy(side, courant, water.heights(), water.heights_before());
    double drift = 0;
    for (unsigned i = 0; i < steps; ++i) {
        water.step();
        if (i % 50 != 0 && i + 1 < steps) continue;
        drift = std::max(drift, std::abs(energy(side, courant, water.heights(), water.heights_before()) / first - 1));
    }
    run.check("drift of the energy of rough water", steps, drift, 1e-5, "of the energy");
    Water unstable(run, side, 0.72, rough_water(side, run.seed()));
    for (unsigned i = 0; i < 200; ++i) unstable.step();
    run.check("growth above the limit, inverse", 200, 1 / highest(unstable.heights()), 1e-6, "");
}

void wave_equation(Run& run) {
    check_stability(run);
    const unsigned coarse = 17, fine = 33;
    const double courant = 0.5, error = 1 - measured_frequency(run, coarse, courant, 1, 2),
                 finer = 1 - measured_frequency(run, fine, courant, 1, 2);
    // The scheme's dispersion: sin^2(w dt / 2) = C^2 (sin^2(kx h / 2) + sin^2(ky h / 2)).
    const double h = 1.0 / (coarse - 1), sine_x = std::sin(pi * h / 2), sine_y = std::sin(pi * h),
                 predicted = 2 * std::asin(courant * std::hypot(sine_x, sine_y)) / (pi * std::sqrt(5.0) * courant * h);
    run.fact("waves of 16 cells along one side and 32 along the other are slower by", printed("%.3f %%", 100 * error));
    run.check("frequency against the scheme's dispersion", 4 * coarse, std::abs(1 - error - predicted), 1e-5, "");
    run.check("order of convergence off 2", 2, std::abs(std::log2(error / finer) - 2), 0.1, "");
    run.check("frequency of diagonal waves at the limit against the exact one", 4 * coarse,
              std::abs(measured_frequency(run, coarse, std::sqrt(0.5), 2, 2) - 1), 1e-5, "");
    const unsigned side = 50, steps = run.count(200u, 5'000u);  // 50 is no multiple of a work-group
    Water water(run, side, 0.7, rough_water(side, run.seed()));
    Heights now = rough_water(side, run.seed()), before = now;
    Tally same;
    for (unsigned i = 0; i < steps; ++i) {
        water.step();
        step_on_host(side, float(0.7 * 0.7), now, before);
        std::swap(now, before);
        if (same.add(water.heights() == now)) run.failure("step " + std::to_string(i) + " has other heights");
    }
    run.check("steps with other heights than on the host", same, "steps");
}

}  // namespace

Cases wave_cases() {
    return {
        {{"wave-equation", "images",
          "Water obeys the wave equation: energy, dispersion, and the same heights everywhere"},
         wave_equation},
    };
}

}  // namespace claray::verify
