// Measures of the difference of two images.
#include "host/render/film/image_error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "host/base/in_parallel.hpp"
#include "host/render/film/pixels.hpp"

namespace claray {
namespace {

using Image = std::vector<glm::vec3>;

// ---- the colour term of FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images",
// section 4.1) ----

constexpr double pixels_a_degree = 67;                       // a 0.7 m wide display of 3840 pixels at 0.7 m
constexpr glm::vec3 white(0.950428545f, 1.f, 1.088900371f);  // XYZ of D65

glm::vec3 xyz_of(const glm::vec3& rgb) {
    return {0.41238656f * rgb.x + 0.35759149f * rgb.y + 0.18045049f * rgb.z,
            0.21263682f * rgb.x + 0.71518298f * rgb.y + 0.07218020f * rgb.z,
            0.01933062f * rgb.x + 0.11919716f * rgb.y + 0.95037259f * rgb.z};
}

glm::vec3 rgb_of_xyz(const glm::vec3& c) {
    return {3.24100326f * c.x - 1.53739899f * c.y - 0.49861587f * c.z,
            -0.96922426f * c.x + 1.87592999f * c.y + 0.04155422f * c.z,
            0.05563942f * c.x - 0.20401120f * c.y + 1.05714897f * c.z};
}

/// Opponent colours that are linear in the light: luminance, red-green, blue-yellow.
glm::vec3 opponent_of(const glm::vec3& rgb) {
    const glm::vec3 c = xyz_of(rgb) / white;
    return {116.f * c.y - 16.f, 500.f * (c.x - c.y), 200.f * (c.y - c.z)};
}

glm::vec3 rgb_of_opponent(const glm::vec3& o) {
    const float y = (o.x + 16.f) / 116.f;
    return rgb_of_xyz(glm::vec3(o.y / 500.f + y, y, y - o.z / 200.f) * white);
}

/// CIELAB with Hunt's adjustment: colours fade in the dark.
glm::vec3 lab_of(const glm::vec3& rgb) {
    const auto curve = [](float t) {
        constexpr float d = 6.f / 29.f;
        return t > d * d * d ? std::cbrt(t) : t / (3.f * d * d) + 4.f / 29.f;
    };
    const glm::vec3 c = xyz_of(rgb) / white;
    const float x = curve(c.x), y = curve(c.y), z = curve(c.z), lightness = 116.f * y - 16.f;
    return {lightness, 5.f * lightness * (x - y), 2.f * lightness * (y - z)};
}

/// The distance of large colour differences (Abasi et al. 2020), compressed.
float distance(const glm::vec3& a, const glm::vec3& b) {
    return std::pow(std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z), 0.7f);
}

/// The eye's contrast sensitivity at a distance of `pixels`, for each opponent colour.
glm::vec3 sensitivity(int pixels) {
    const double x = pixels / pixels_a_degree, x2 = x * x, pi2 = 9.8696044;
    const auto bell = [&](double a, double b) { return a * std::sqrt(3.14159265 / b) * std::exp(-pi2 * x2 / b); };
    return {float(bell(1, 0.0047)), float(bell(1, 0.0053)), float(bell(34.1, 0.04) + bell(13.5, 0.025))};
}

/// The blue-yellow filter is a sum of two bells, which is not separable; as in FLIP's own later versions each bell is,
/// and their difference in shape is far below what the measure tells apart.
Image blurred(const Image& image, unsigned width) {
    const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * 9.8696044)) * pixels_a_degree));
    std::vector<glm::vec3> weights(std::size_t(2 * radius + 1));
    glm::vec3 sum(0);
    for (int i = -radius; i <= radius; ++i) sum += weights[std::size_t(i + radius)] = sensitivity(i);
    for (glm::vec3& w : weights) w /= sum;
    const int w = int(width), h = int(image.size()) / w;
    const auto pass = [&](const Image& from, bool rows) {
        Image to(from.size(), glm::vec3(0));
        in_parallel(std::size_t(h), [&](std::size_t row) {
            const int y = int(row);
            for (int x = 0; x < w; ++x)
                for (int i = -radius; i <= radius; ++i) {
                    const int sx = rows ? std::clamp(x + i, 0, w - 1) : x, sy = rows ? y : std::clamp(y + i, 0, h - 1);
                    to[std::size_t(y * w + x)] += weights[std::size_t(i + radius)] * from[std::size_t(sy * w + sx)];
                }
        });
        return to;
    };
    return pass(pass(image, true), false);
}

/// The image as perceived: exposed, blurred, in a space whose distances are perceived differences.
Image seen(std::span<const glm::vec3> image, float exposure, unsigned width) {
    Image opponent(image.size());
    const auto in_rows = [&](const auto& change) {
        in_parallel(image.size() / width, [&](std::size_t row) {
            for (std::size_t i = row * width; i < (row + 1) * width; ++i) change(i);
        });
    };
    in_rows([&](std::size_t i) { opponent[i] = opponent_of(glm::clamp(image[i] * exposure, 0.f, 1.f)); });
    Image result = blurred(opponent, width);
    in_rows([&](std::size_t i) { result[i] = lab_of(glm::clamp(rgb_of_opponent(result[i]), 0.f, 1.f)); });
    return result;
}

/// FLIP's map of large distances to the rest of the scale.
float compressed(float distance) {
    constexpr float knee = 0.4f, at_knee = 0.95f;
    return distance < knee ? distance * at_knee / knee : at_knee + (distance - knee) / (1 - knee) * (1 - at_knee);
}

}  // namespace

ErrorAgainst::ErrorAgainst(std::vector<glm::vec3> reference, unsigned width)
    : reference_(std::move(reference)), width_(width) {
    if (reference_.empty() || width == 0 || reference_.size() % width != 0)
        throw Error(ErrorKind::usage, "cannot compare with an image of " + std::to_string(reference_.size()) +
                                          " pixels in rows of " + std::to_string(width));
    mean_ = std::max(mean_of(reference_), 1e-30);
    seen_ = seen(reference_, float(0.3 / mean_), width);
}

ImageError ErrorAgainst::operator()(std::span<const glm::vec3> image) const {
    if (image.size() != reference_.size())
        throw Error(ErrorKind::usage, "cannot compare an image of " + std::to_string(image.size()) +
                                          " pixels with one of " + std::to_string(reference_.size()));
    const Image perceived = seen(image, float(0.3 / mean_), width_);
    const float farthest = distance(lab_of({0, 1, 0}), lab_of({0, 0, 1}));
    const double least = 0.01 * mean_;
    struct Sums {
        double squares = 0, relative = 0, perceptual = 0;
        Sums operator+(const Sums& s) const {
            return {squares + s.squares, relative + s.relative, perceptual + s.perceptual};
        }
    };
    std::vector<Sums> rows(image.size() / width_);
    in_parallel(rows.size(), [&](std::size_t row) {
        Sums& sums = rows[row];
        for (std::size_t i = row * width_; i < (row + 1) * width_; ++i) {
            for (int c = 0; c < 3; ++c) {
                const double difference = double(image[i][c]) - double(reference_[i][c]);
                const double scaled = difference / (double(reference_[i][c]) + least);
                sums.squares += difference * difference;
                sums.relative += scaled * scaled;
            }
            sums.perceptual += double(compressed(distance(perceived[i], seen_[i]) / farthest));
        }
    });
    const Sums all = std::accumulate(rows.begin(), rows.end(), Sums());
    const double pixels = double(image.size());
    return {std::sqrt(all.squares / (3 * pixels)) / mean_, all.relative / (3 * pixels), all.perceptual / pixels};
}

ImageError image_error(std::span<const glm::vec3> image, std::span<const glm::vec3> reference, unsigned width) {
    return ErrorAgainst({reference.begin(), reference.end()}, width)(image);
}

}  // namespace claray
