#include "host/render/film/error_looks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace claray {
namespace {

/// If fewer pixels than these have all the error, they are mostly pixels with a firefly.
constexpr double least_degrees = 6;
/// If this many pixels share it, the estimate of a look is within a tenth, and the error falls with the samples to the
/// power of 0.6: between 0.5 for independent samples and 1 for smooth images with Sobol points.
constexpr double many_degrees = 200, samples_to_error = 1 / 0.6;

/// The quantile of Fisher's F distribution with as many degrees of freedom above as below that a normal variable has at
/// `deviations` (Abramowitz and Stegun 1964, 26.6.16, whose second term vanishes).
double quantile_of_f(double degrees, double deviations) {
    const double h = degrees - 1, lambda = (deviations * deviations - 3) / 6;
    return std::exp(2 * deviations * std::sqrt(h + lambda) / h);
}

}  // namespace

/// The factor by which the halves tell too much. They complete each other: with a squared error of c n^-p after n
/// samples, of c (n/2)^-p in each half, the expectation of their squared half difference is 2^p - 1 times the squared
/// error. Its power of 3/4 is used. If a part of the error falls by 1/n and the rest by 1/n^2, the difference falls
/// faster than the error, and the full factor would tell as little as 3/4 of the squared error. p is that of the looks
/// so far, less a standard deviation.
double ErrorLooks::excess_of_halves(double of_halves, std::uint32_t samples) {
    if (count == 0 || !(of_halves > 0 && halves > 0)) return 1;
    const double doublings = std::log2(double(samples) / spp),
                 weight = count == 1 ? 1 : std::min(1., doublings) * 2 / 3;
    power += weight * (std::log2(halves / of_halves) / doublings - power);
    const double sure = std::clamp(power - 2 / std::sqrt(std::max(degrees, 1.)), 1., 2.);
    return std::pow(std::exp2(sure) - 1, 0.75);
}

/// Estimates after n / 2 and after n samples have a correlation of 1/2, because half of the samples are the same. The
/// squared error falls at least with the samples, so that scaled earlier estimates are not too small. Weights of 2/3,
/// 2/9, 2/27 ... make the variance 0.7 of that of one look, like 1.4 times the degrees. The squared error of a firefly
/// falls with the square of the samples; then the sum is at most 1.5 times the present value.
void ErrorLooks::add(double of_halves, double its_degrees, std::uint32_t samples) {
    if (samples == spp) return;
    const double estimated_square = of_halves / excess_of_halves(of_halves, samples);
    const double before = count == 0 ? 0 : 1. / 3;
    double known = square * spp / samples;
    if (its_degrees < least_degrees) known = std::min(known, 1.5 * estimated_square);
    square = (1 - before) * estimated_square + before * known;
    degrees = (1 - before) * its_degrees + before * degrees;
    last = estimated_square, halves = of_halves, spp = samples, ++count;
}

/// A firefly is in the image and in the estimate alike, so that a larger factor would gain nothing.
double ErrorLooks::bound() const {
    constexpr double deviations = 2, gain_of_looks = 1.4;
    const double all = count > 1 ? gain_of_looks * degrees : degrees;
    return std::sqrt(std::max(last, square * quantile_of_f(std::max(all, least_degrees), deviations)));
}

/// The next look is after the samples that are needed if many pixels share the error; else as if the error fell with
/// their number, which holds if a firefly has most of it. At least an eighth more, because each look is a chance to
/// stop by luck; at most twice as many, because estimates from few samples are rough. A power of two nearby is
/// preferred: Sobol points are even there, and slightly fewer samples are often not enough. This does not depend on how
/// many samples a device traces at once.
std::uint32_t ErrorLooks::next(double error) const {
    constexpr std::uint32_t first = 4;
    if (count == 0) return first;
    const double ratio = bound() / error, done = spp;
    if (ratio <= 1) return spp;
    const double times = std::pow(ratio, degrees < many_degrees ? 1 : samples_to_error);
    const auto then = std::uint32_t(done + std::clamp(std::ceil((times - 1) * done), std::ceil(done / 8), done));
    const std::uint32_t power = std::bit_ceil(then);
    return power - then <= power / 8 && power <= 2 * spp ? power : then;
}

}  // namespace claray
