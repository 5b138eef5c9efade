#include "host/verify/cases/expected_values.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace claray::verify {
namespace {

constexpr std::string_view letters = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz+-";
constexpr unsigned letters_each = 4, sign_bit = 1u << 23;
constexpr double per_octave = 1 << 17, lowest_octave = -32;
constexpr double relative_tolerance = 3e-5, tolerance_of_mean = 1e-5;

/// Steps of the logarithm, and the sign; 0 for numbers below 2^-32.
unsigned code_of(float value) {
    if (std::isnan(value)) return 0;
    const double octave = std::log2(std::abs(double(value))) - lowest_octave;
    const double steps = std::clamp(octave * per_octave, 0.0, double(sign_bit - 1));
    return unsigned(std::lround(steps)) | (steps > 0 && value < 0 ? sign_bit : 0);
}

double value_of(unsigned code) {
    const unsigned steps = code & (sign_bit - 1);
    return steps == 0 ? 0 : std::exp2(steps / per_octave + lowest_octave) * (code & sign_bit ? -1 : 1);
}

std::vector<double> unpacked(std::string_view text) {
    std::vector<double> values;
    for (std::size_t i = 0; i + letters_each <= text.size(); i += letters_each) {
        unsigned code = 0;
        for (const char letter : text.substr(i, letters_each)) code = code * 64 + unsigned(letters.find(letter));
        values.push_back(value_of(code));
    }
    return values;
}

const std::map<std::string_view, std::string_view>& committed_values() {
    static const std::map<std::string_view, std::string_view> values = {
#include "host/verify/cases/expected_values.inc"
    };
    return values;
}

}  // namespace

std::string packed(std::span<const float> values) {
    std::string text;
    for (const float value : values) {
        const unsigned code = code_of(value);
        for (unsigned k = letters_each; k-- > 0;) text += letters[code >> 6 * k & 63];
    }
    return text;
}

std::vector<float> sums_of_blocks(std::span<const float> pixels, unsigned width, unsigned channels, unsigned side) {
    const std::size_t height = pixels.size() / (std::size_t(width) * channels);
    const std::size_t columns = (width + side - 1) / side, rows = (height + side - 1) / side;
    std::vector<double> sums(columns * rows * channels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const std::size_t pixel = i / channels, block = pixel / width / side * columns + pixel % width / side;
        sums[block * channels + i % channels] += double(pixels[i]);
    }
    return {sums.begin(), sums.end()};
}

void Committed::compare(const std::string& name, std::span<const float> values) {
    const auto found = committed_values().find(name);
    const std::vector<double> expected = found == committed_values().end() ? std::vector<double>() : unpacked(found->second);
    double mean = 0;
    for (const double e : expected) mean += std::abs(e) / double(expected.size());
    std::uint64_t wrong = expected.size() == values.size() ? 0 : values.size();
    for (std::size_t i = 0; i < values.size() && expected.size() == values.size(); ++i) {
        const double error = std::abs(value_of(code_of(values[i])) - expected[i]);
        wrong += error > relative_tolerance * std::abs(expected[i]) + tolerance_of_mean * mean;
    }
    tried_ += values.size(), wrong_ += wrong, most_wrong_ = std::max(most_wrong_, wrong);
    if (wrong == 0) return;
    run_.failure(name + ": " + std::to_string(wrong) + " of " + std::to_string(values.size()) +
                 " values differ; found " + packed(values));
}

void Committed::compare_image(const std::string& name, std::span<const glm::vec3> image, unsigned width) {
    compare(name, sums_of_blocks(std::span(&image[0].x, 3 * image.size()), width, 3, 8));
}

void Committed::check(const std::string& what, std::uint64_t of_one) const {
    constexpr std::uint64_t spared = 1000;
    run_.check(what, tried_, double(wrong_), double(tried_ / spared + of_one), "values");
    run_.check(what + ", of one of them", tried_, double(most_wrong_), double(of_one), "values");
}

}  // namespace claray::verify
