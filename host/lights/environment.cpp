#include "host/lights/environment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "claray/error.hpp"
#include "host/lights/luminance.hpp"

namespace claray {
namespace {

using std::numbers::pi;

float linear(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

/// An image in linear RGB.
struct Pixels {
    explicit Pixels(const Texture& texture);
    [[nodiscard]] const glm::vec3& at(unsigned x, unsigned y) const { return values[std::size_t(y) * width + x]; }
    [[nodiscard]] glm::vec3 bilinear(double u, double v) const;
    unsigned width, height;
    std::vector<glm::vec3> values;
};

Pixels::Pixels(const Texture& texture) : width(texture.width), height(texture.height) {
    const std::size_t texels = std::size_t(width) * height;
    const bool floats = texture.format == TexelFormat::float32;
    if (texels == 0 || (floats ? texture.floats.size() : texture.bytes.size()) != texels * texture.channels)
        throw Error(ErrorKind::user, "environment '" + texture.name + "': its size is not that of its texels",
                    "give width * height * channels numbers");
    float values_of_bytes[256];
    for (int i = 0; i < 256; ++i)
        values_of_bytes[i] = texture.format == TexelFormat::srgb8 ? linear(float(i) / 255.f) : float(i) / 255.f;
    const unsigned colors = texture.channels >= 3 ? 3 : 1;
    values.resize(texels);
    for (std::size_t i = 0; i < texels; ++i)
        for (unsigned c = 0; c < 3; ++c) {
            const std::size_t at = i * texture.channels + std::min(c, colors - 1);
            const float value = floats ? texture.floats[at] : values_of_bytes[texture.bytes[at]];
            if (!(value >= 0.f && std::isfinite(value)))
                throw Error(ErrorKind::user,
                            "environment '" + texture.name + "': the texel at column " + std::to_string(i % width) +
                                ", row " + std::to_string(i / width) + " is negative or not finite",
                            "correct the image");
            values[i][int(c)] = value;
        }
}

/// Bilinear between texel centres; the border's texels extend outwards.
glm::vec3 Pixels::bilinear(double u, double v) const {
    const double x = std::clamp(u * width - 0.5, 0.0, width - 1.0), y = std::clamp(v * height - 0.5, 0.0, height - 1.0);
    const unsigned x0 = unsigned(x), y0 = unsigned(y), x1 = std::min(x0 + 1, width - 1),
                   y1 = std::min(y0 + 1, height - 1);
    const auto fx = float(x - x0), fy = float(y - y0);
    return glm::mix(glm::mix(at(x0, y0), at(x1, y0), fx), glm::mix(at(x0, y1), at(x1, y1), fx), fy);
}

/// The radiance of a cube map in a direction; faces as in the OpenGL specification, table 8.19.
glm::vec3 cube_radiance(const std::vector<Pixels>& faces, const glm::dvec3& d) {
    const glm::dvec3 a = glm::abs(d);
    if (a.x >= a.y && a.x >= a.z) {
        const double s = d.x > 0 ? -d.z : d.z;
        return faces[d.x > 0 ? 0 : 1].bilinear(0.5 + 0.5 * s / a.x, 0.5 - 0.5 * d.y / a.x);
    }
    if (a.y >= a.z) {
        const double t = d.y > 0 ? d.z : -d.z;
        return faces[d.y > 0 ? 2 : 3].bilinear(0.5 + 0.5 * d.x / a.y, 0.5 + 0.5 * t / a.y);
    }
    const double s = d.z > 0 ? d.x : -d.x;
    return faces[d.z > 0 ? 4 : 5].bilinear(0.5 + 0.5 * s / a.z, 0.5 - 0.5 * d.y / a.z);
}

/// Four samples per texel along each axis.
Pixels unfold(const std::vector<Pixels>& faces) {
    Texture texture;
    texture.width = 4 * faces[0].width, texture.height = 2 * faces[0].width;
    texture.channels = 1, texture.format = TexelFormat::float32;
    texture.floats.resize(std::size_t(texture.width) * texture.height);
    Pixels image(texture);
    constexpr int side = 4;
    for (unsigned y = 0; y < image.height; ++y)
        for (unsigned x = 0; x < image.width; ++x) {
            glm::dvec3 sum(0.0);
            for (int sample = 0; sample < side * side; ++sample) {
                const double across = 2 * pi * ((x + (sample % side + 0.5) / side) / image.width - 0.5);
                const double down = pi * (y + (sample / side + 0.5) / side) / image.height;
                sum += glm::dvec3(cube_radiance(
                    faces, {std::sin(down) * std::sin(across), std::cos(down), -std::sin(down) * std::cos(across)}));
            }
            image.values[std::size_t(y) * image.width + x] = glm::vec3(sum / double(side * side));
        }
    return image;
}

Pixels pixels_of(const Environment& environment) {
    const std::vector<Texture>& images = environment.images;
    if (images.size() == 1) return Pixels(images[0]);
    std::vector<Pixels> faces(images.begin(), images.end());
    for (const Pixels& face : faces)
        if (faces.size() != 6 || face.width != faces[0].width || face.height != face.width)
            throw Error(ErrorKind::user, "an environment of " + std::to_string(images.size()) + " images",
                        "give one image, or six squares of one size: +x -x +y -y +z -z");
    return unfold(faces);
}

/// The index of the first number above the lower end of each part of 0..1.
void write_starts(std::uint32_t count, float* cdf) {
    std::uint32_t at = 0;
    for (std::uint32_t part = 0; part <= CLARAY_CDF_PARTS; ++part) {
        while (at + 1 < count && cdf[at] <= float(part) / float(CLARAY_CDF_PARTS)) ++at;
        cdf[count + part] = float(at);
    }
}

/// Writes the cumulative distribution and its starts; returns the total. If all weights are 0 it is uniform.
double normalize_cdf(const std::vector<double>& weights, float* cdf) {
    double total = 0, sum = 0;
    for (const double weight : weights) total += weight;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i];
        cdf[i] = float(total > 0 ? sum / total : double(i + 1) / double(weights.size()));
    }
    cdf[weights.size() - 1] = 1.f;
    write_starts(std::uint32_t(weights.size()), cdf);
    return total;
}

/// The mean over all directions of a function of the luminance.
template <class Function>
double mean_of(const Pixels& pixels, Function&& function) {
    double sum = 0, sines = 0;
    for (unsigned y = 0; y < pixels.height; ++y) {
        const double sine = std::sin(pi * (y + 0.5) / pixels.height);
        for (unsigned x = 0; x < pixels.width; ++x) sum += sine * function(luminance(pixels.at(x, y)));
        sines += sine * pixels.width;
    }
    return sum / sines;
}

/// BSDF sampling finds directions up to the mean luminance as well, so that only brighter ones need to be sampled often
/// (Karlik et al. 2019, "MIS Compensation", section 5). An image that has none is sampled everywhere alike.
double baseline_of(const Pixels& pixels, double mean) {
    constexpr double least_above = 1e-3;  // of all light; below, roundings would decide
    const double above = mean_of(pixels, [&](double value) { return std::max(value - mean, 0.0); });
    return above > least_above * mean ? mean : 0;
}

/// Writes the cumulative distributions of lights/environment.clh. Returns the sum of all texels' densities.
double distribute(const Pixels& pixels, double strength, double baseline, std::vector<float>& cdf) {
    // The cells lie between the centres of texels. The weight at the border above row y of cells, in column x, is that
    // of the texels whose centres are on this border; 0 at the poles.
    const auto weight = [&](unsigned x, unsigned y) {
        if (y == 0 || y > pixels.height) return 0.0;
        const double all = luminance(pixels.at(x % pixels.width, y - 1)) * strength;
        return std::max(all - baseline, double(CLARAY_LEAST_SAMPLED) * all) * std::sin(pi * (y - 0.5) / pixels.height);
    };
    const unsigned rows = pixels.height + 1;
    const std::size_t words_of_rows = CLARAY_CDF_WORDS(rows), words_of_row = CLARAY_CDF_WORDS(pixels.width);
    cdf.resize(words_of_rows + rows * words_of_row);
    std::vector<double> of_rows(rows), of_cells(pixels.width);
    for (unsigned y = 0; y < rows; ++y) {
        const double area = y == 0 || y == pixels.height ? 0.5 : 1.0;  // of a cell, in texels
        for (unsigned x = 0; x < pixels.width; ++x)
            of_cells[x] = 0.25 * area * (weight(x, y) + weight(x + 1, y) + weight(x, y + 1) + weight(x + 1, y + 1));
        of_rows[y] = normalize_cdf(of_cells, &cdf[words_of_rows + y * words_of_row]);
    }
    return normalize_cdf(of_rows, cdf.data());
}

}  // namespace

EnvironmentImage environment_image(const Environment& environment, bool compensates) {
    const Pixels pixels = pixels_of(environment);
    EnvironmentImage image;
    image.width = pixels.width, image.height = pixels.height;
    for (const glm::vec3& value : pixels.values)
        for (int c = 0; c < 3; ++c) image.texels.push_back(value[c] * environment.strength);

    const double mean = mean_of(pixels, [](double value) { return value; });
    image.integral = 4 * pi * environment.strength * mean;
    if (compensates) image.baseline = float(environment.strength * baseline_of(pixels, mean));
    const double texel = 2 * pi * pi / (double(image.width) * image.height);  // d(direction) / sine
    const double sampled = distribute(pixels, environment.strength, image.baseline, image.cdf) * texel;
    if (sampled > 0) image.density = float(1 / sampled);
    return image;
}

}  // namespace claray
