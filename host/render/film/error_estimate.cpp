#include "host/render/film/error_estimate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

#include "host/lights/luminance.hpp"
#include "host/render/film/pixels.hpp"

namespace claray {
namespace {

constexpr int radius = 3;             // of the pixels around that tell the expected variance
constexpr float most_of_one = 16;     // times the mean around: more is a firefly's, and its neighbours do not have it
constexpr double settled = 0.98;      // of the sum before: single pixels have no more of it
constexpr double most_expected = 48;  // times the expected variance: what exceeds it is told pixel by pixel
constexpr float least_variance = 1e-24f;  // relative to the mean: 1e-12, below the rounding of float32
constexpr std::uint32_t share_of_controls = 16, least_controls = 1024;

/// Means over the pixels of a row, or a column, that are at most `radius` away. Borders mirror the pixels behind them,
/// so that none counts twice there.
void smooth(const float* from, float* to, std::ptrdiff_t count, std::ptrdiff_t stride) {
    const auto at = [&](std::ptrdiff_t i) {
        const std::ptrdiff_t last = count - 1, mirrored = i < 0 ? -i : i > last ? 2 * last - i : i;
        return double(from[std::clamp<std::ptrdiff_t>(mirrored, 0, last) * stride]);
    };
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += at(i);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        to[i * stride] = float(std::max(sum, 0.0) / (2 * radius + 1));
        sum += at(i + radius + 1) - at(i - radius);
    }
}

std::vector<float> smoothed(const std::vector<float>& image, std::uint32_t width) {
    const std::size_t height = image.size() / width;
    std::vector<float> rows(image.size()), both(image.size());
    for (std::size_t y = 0; y < height; ++y) smooth(&image[y * width], &rows[y * width], width, 1);
    for (std::size_t x = 0; x < width; ++x) smooth(&rows[x], &both[x], std::ptrdiff_t(height), width);
    return both;
}

/// The chances with which so many pixels are picked, at most 1 each.
std::vector<double> chances_of(std::span<const float> expected, std::size_t count) {
    const double sum = std::accumulate(expected.begin(), expected.end(), 0.0), even = 1.0 / double(expected.size());
    std::vector<double> chances(expected.size());
    for (std::size_t i = 0; i < chances.size(); ++i) chances[i] = 0.5 * even + 0.5 * double(expected[i]) / sum;
    const std::vector<double> shares = chances;
    double factor = double(count);
    for (int round = 0; round < 4; ++round) {  // what some have too much goes to the others
        double full = 0, rest = 0;
        for (const double share : shares) (factor * share >= 1 ? full : rest) += factor * share >= 1 ? 1 : share;
        if (rest > 0 && double(count) > full) factor = (double(count) - full) / rest;
    }
    for (std::size_t i = 0; i < chances.size(); ++i) chances[i] = std::min(1.0, factor * shares[i]);
    return chances;
}

glm::dvec3 mean_of(const ColorSum& sum, double count) {
    return glm::dvec3(double(sum.r) + sum.lost_r, double(sum.g) + sum.lost_g, double(sum.b) + sum.lost_b) / count;
}

/// What differs between both estimates of a control pixel.
glm::dvec3 difference_at(const ControlPixel& control, std::span<const glm::vec3> image) {
    return glm::dvec3(image[control.pixel]) - mean_of(control.sums.all, std::max(1u, control.sums.count));
}

/// What the control pixels tell, relative to the mean of the image.
class ControlErrors {
public:
    ControlErrors(std::span<const glm::vec3> image, double mean, std::span<const float> expected,
                  std::span<const ControlPixel> controls)
        : controls_(controls) {
        for (const ControlPixel& control : controls) {
            const glm::dvec3 difference = difference_at(control, image) / mean;
            squares_.push_back(glm::dot(difference, difference) / 6);  // half, of three channels
            expected_.push_back(double(expected[control.pixel]));
        }
        for (int round = 0; round < 4; ++round) scale_ = scale_within(limit());
    }

    /// The squared error over the expected variance.
    [[nodiscard]] double scale() const { return scale_; }
    /// The variance of the sum over the image that has this scale.
    [[nodiscard]] double variance_of_sum() const {
        double sum = 0;
        for (std::size_t k = 0; k < squares_.size(); ++k) {
            const double rest = (at(k, limit()) - scale_ * expected_[k]) / chance(k);
            sum += rest * rest;
        }
        return sum;
    }

    /// Half the squared difference of a control pixel, and whether a firefly makes it.
    [[nodiscard]] double square(std::size_t k) const { return squares_[k]; }
    [[nodiscard]] bool has_firefly(std::size_t k) const { return squares_[k] > limit() * expected_[k]; }

private:
    /// Of a square, over the expected variance.
    [[nodiscard]] double limit() const { return most_expected * std::max(1.0, scale_); }
    [[nodiscard]] double chance(std::size_t k) const { return double(controls_[k].chance); }
    [[nodiscard]] double at(std::size_t k, double most) const { return std::min(squares_[k], most * expected_[k]); }
    /// Hajek's ratio estimator (1971). A firefly of the control pixels is none of the image.
    [[nodiscard]] double scale_within(double most) const {
        double sum = 0, sum_expected = 0;
        for (std::size_t k = 0; k < squares_.size(); ++k)
            sum += at(k, most) / chance(k), sum_expected += expected_[k] / chance(k);
        return sum / sum_expected;
    }

    std::span<const ControlPixel> controls_;
    std::vector<double> squares_, expected_;
    double scale_ = 1;
};

}  // namespace

std::vector<float> expected_variances(std::span<const float> variances, std::uint32_t width) {
    std::vector<float> at_most(variances.begin(), variances.end()), expected;
    double before = 0, sum = std::accumulate(at_most.begin(), at_most.end(), 0.0);
    do {
        expected = smoothed(at_most, width), before = sum, sum = 0;
        for (std::size_t i = 0; i < at_most.size(); ++i) {
            expected[i] = std::max(expected[i], least_variance);
            sum += double(at_most[i] = std::min(variances[i], most_of_one * expected[i]));
        }
    } while (sum < settled * before);
    return expected;
}

std::vector<ControlPixel> pick_control_pixels(std::span<const float> expected, std::uint32_t seed) {
    const auto pixels = std::uint32_t(expected.size());
    const std::uint32_t most = most_control_pixels - 1;  // systematic sampling may pick one more
    const std::uint32_t wanted = std::clamp(pixels / share_of_controls, least_controls, most);
    const std::vector<double> chances = chances_of(expected, std::min(wanted, pixels));
    std::mt19937 random(seed);
    double next = random() / 4294967296.0, sum = 0;
    std::vector<ControlPixel> controls;
    for (std::uint32_t i = 0; i < pixels; ++i) {
        sum += chances[i];
        if (sum <= next && chances[i] < 1) continue;
        controls.push_back({i, float(chances[i]), {}});
        next += 1;
    }
    return controls;
}

/// What pixels of the image have beyond `most_expected` is added as it is: a firefly is in one half of the samples,
/// whose difference is then the error.
ErrorEstimate estimate_error(std::span<const glm::vec3> image, std::span<const float> variances,
                             std::span<const float> expected, std::span<const ControlPixel> controls) {
    const double mean = mean_of(image);
    if (!(mean > 0) || controls.empty()) return {};
    const ControlErrors errors(image, mean, expected, controls);
    double square = 0, fireflies = 0, squared_fireflies = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        square += errors.scale() * double(expected[i]);
        const double beyond = std::max(0.0, double(variances[i]) - most_expected * double(expected[i]));
        fireflies += beyond, squared_fireflies += beyond * beyond;
    }
    const auto pixels = double(expected.size());
    constexpr double rounding = 0x1p-48;  // of any float32 image
    return {std::max(rounding, (square + fireflies) / pixels),
            std::sqrt(errors.variance_of_sum() + squared_fireflies) / pixels,
            fireflies > 0 ? fireflies / (square + fireflies) : 0};
}

/// By the control pixels' quantile of the difference over the deviation that is expected, which holds for any
/// distribution of errors (conformal prediction: Vovk, Gammerman and Shafer 2005). A quarter of a pixel's own variance
/// is in it.
std::vector<float> error_intervals(std::span<const glm::vec3> image, std::span<const float> variances,
                                   std::span<const float> expected, std::span<const ControlPixel> controls,
                                   double confidence) {
    constexpr double own = 0.25, rounding = 1e-6;
    std::vector<float> widths(image.size());
    for (std::size_t i = 0; i < image.size(); ++i)
        widths[i] = float(std::sqrt(own * double(variances[i]) + (1 - own) * double(expected[i])) +
                          rounding * std::abs(luminance(image[i])));
    struct Weighted {
        double ratio, weight;
    };
    std::vector<Weighted> ratios;
    double all = 0;
    for (const ControlPixel& c : controls) {
        const double difference = std::abs(luminance(difference_at(c, image))) / std::sqrt(2.0);
        ratios.push_back({difference / double(widths[c.pixel]), 1 / double(c.chance)});
        all += ratios.back().weight;
    }
    std::sort(ratios.begin(), ratios.end(), [](const Weighted& a, const Weighted& b) { return a.ratio < b.ratio; });
    double sum = 0, factor = 0;
    for (const Weighted& one : ratios) {
        factor = one.ratio, sum += one.weight;
        if (sum >= confidence * all) break;
    }
    for (float& width : widths) width = float(factor * double(width));
    return widths;
}

/// The squared difference to the control pixels has their variance, too; half of what they differ from `image` is that.
/// The noise of the control pixels is in both, so that it nearly cancels.
double error_of_other(std::span<const glm::vec3> other, std::span<const glm::vec3> image,
                      std::span<const float> expected, std::span<const ControlPixel> controls) {
    const double mean = mean_of(other);
    if (!(mean > 0) || controls.empty()) return 0;
    const ControlErrors errors(image, mean, expected, controls);
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < controls.size(); ++k) {
        if (errors.has_firefly(k)) continue;
        const glm::dvec3 difference = difference_at(controls[k], other) / mean;
        const double weight = 1 / double(controls[k].chance);
        sum += weight * (glm::dot(difference, difference) / 3 - errors.square(k)), weights += weight;
    }
    return sum > 0 ? std::sqrt(sum / weights) : 0;
}

/// The product of the differences to independent estimates has the squared error as its expectation.
double error_by_both(std::span<const glm::vec3> image, std::span<const ControlPixel> first,
                     std::span<const ControlPixel> second) {
    const double mean = mean_of(image);
    if (!(mean > 0) || first.empty()) return 0;
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < first.size(); ++k) {
        const double weight = 1 / double(first[k].chance);
        sum += weight * glm::dot(difference_at(first[k], image), difference_at(second[k], image)) / 3;
        weights += weight;
    }
    return sum > 0 ? std::sqrt(sum / weights) / mean : 0;
}

void ErrorProgress::add(const ErrorEstimate& estimate, std::uint32_t samples) {
    if (spp != 0 && samples > spp && estimate.square > 0 && last.square > 0)
        power = std::log(last.square / estimate.square) / std::log(double(samples) / spp);
    last = estimate, spp = samples;
}

double ErrorProgress::bound() const {
    constexpr double deviations = 2.5;
    return last.square + deviations * last.deviation;
}

/// The squared error falls by the samples to a power from 1, of independent samples, to 2, of smooth images with Sobol
/// points. The last two estimates tell which, roughly. At least a sixteenth more, because each look is a chance to stop
/// by luck; at most twice as many. A power of two nearby is preferred: Sobol points are even there. This does not
/// depend on how many samples a device traces at once.
std::uint32_t ErrorProgress::next(double error) const {
    constexpr std::uint32_t first = 4;
    if (spp == 0) return first;
    const double ratio = bound() / (error * error), done = spp;
    if (last.square > 0 && ratio <= 1) return spp;
    const double times = last.square > 0 ? std::pow(ratio, 1 / std::clamp(power, 1.0, 1.5)) : 2;
    const auto then = std::uint32_t(done + std::clamp(std::ceil((times - 1) * done), std::ceil(done / 16), done));
    const std::uint32_t even = std::bit_ceil(then);
    return even - then <= even / 8 && even <= 2 * spp ? even : then;
}

}  // namespace claray
