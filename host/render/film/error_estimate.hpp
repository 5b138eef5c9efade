// The error of an image, told by pixels that are rendered a second time with other random numbers. The difference of
// both estimates has twice the variance of one, however the samples of a pixel complete each other.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "claray/shared/path.h"

namespace claray {

/// A pixel that is rendered again, as many times as in the image.
struct ControlPixel {
    std::uint32_t pixel;
    float chance;    // with which it was picked
    FilmPixel sums;  // of the second time
};

/// The variance to be expected of each pixel: the mean over 7x7 pixels, in which single ones count 16 times the mean at
/// most. Of a pixel itself two halves of its samples tell too little.
[[nodiscard]] std::vector<float> expected_variances(std::span<const float> variances, std::uint32_t width);

inline constexpr std::uint32_t most_control_pixels = 4096;

/// Picks pixels, half of them evenly and half in proportion to the expected variance, by systematic sampling (Madow
/// 1949). About a sixteenth of the image, at least 1,024 and at most `most_control_pixels`, or all of a smaller image.
[[nodiscard]] std::vector<ControlPixel> pick_control_pixels(std::span<const float> expected, std::uint32_t seed);

/// All relative to the mean of the image.
struct ErrorEstimate {
    double square = 0;     ///< expected squared error of all channels
    double deviation = 0;  ///< of that, as far as the control pixels tell
    double fireflies = 0;  ///< the part of `square` that single pixels have, each more than the pixels around explain
};

/// `image`: mean radiance. `variances`: of each pixel's luminance over the squared mean of the image's, from the halves
/// of its samples; the control pixels find their scale. Both have as many samples as the control pixels.
[[nodiscard]] ErrorEstimate estimate_error(std::span<const glm::vec3> image, std::span<const float> variances,
                                           std::span<const float> expected, std::span<const ControlPixel> controls);

/// Half the width of the interval that holds a pixel's true luminance with this confidence, for each pixel. Arguments
/// as of estimate_error.
[[nodiscard]] std::vector<float> error_intervals(std::span<const glm::vec3> image, std::span<const float> variances,
                                                 std::span<const float> expected,
                                                 std::span<const ControlPixel> controls, double confidence = 0.95);

/// The error of another image of the same scene, such as a denoised one: root mean square of all channels over its
/// mean; 0 if the control pixels cannot tell it from 0. Noise of the control pixels is taken away by what differs
/// between them and `image`; pixels with fireflies are left out.
[[nodiscard]] double error_of_other(std::span<const glm::vec3> other, std::span<const glm::vec3> image,
                                    std::span<const float> expected, std::span<const ControlPixel> controls);

/// The error of an image, as error_of_other, by two independent estimates of the same pixels.
[[nodiscard]] double error_by_both(std::span<const glm::vec3> image, std::span<const ControlPixel> first,
                                   std::span<const ControlPixel> second);

/// The knowledge of a render about its error. It decides where a render stops; therefore checkpoints store it.
struct ErrorProgress {
    ErrorEstimate last;
    double power = 0;  // of the samples, by which the squared error fell between the last two estimates; 0: unknown
    std::uint32_t spp = 0;  // samples per pixel at the last estimate
    std::vector<ControlPixel> controls;

    void add(const ErrorEstimate& estimate, std::uint32_t samples);
    /// The squared error exceeds it in about one render of a hundred, unless fireflies have much of it.
    [[nodiscard]] double bound() const;
    /// The samples per pixel after which to estimate again; those of the last estimate if they suffice.
    [[nodiscard]] std::uint32_t next(double error) const;
};

}  // namespace claray
