// The format is in "Radiance File Formats" (Ward) and in the functions of Radiance's color.c and header.c.
#include "host/io/image/formats/radiance.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "host/io/image/formats/primaries.hpp"

namespace claray {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

/// The next line, without its end.
std::string_view take_line(std::string_view& rest) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string_view take_word(std::string_view& rest) {
    const std::size_t begin = std::min(rest.find_first_not_of(" \t"), rest.size());
    const std::size_t end = std::min(rest.find_first_of(" \t", begin), rest.size());
    const std::string_view word = rest.substr(begin, end - begin);
    rest.remove_prefix(end);
    return word;
}

/// The numbers in a text; fewer if it has others.
std::vector<double> numbers_of(std::string_view text) {
    std::vector<double> numbers;
    for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
        if (word.front() == '+') word.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) break;
        numbers.push_back(value);
    }
    return numbers;
}

/// Reads the variables up to the empty line. Returns what is wrong.
std::string read_variables(std::string_view& rest, RadianceHeader& header) {
    glm::dvec3 exposure(1.0);
    bool is_xyz = false;
    glm::dmat3 primaries(1.0);
    for (std::string_view line = take_line(rest); !line.empty(); line = take_line(rest)) {
        const std::size_t equals = line.find('=');
        if (rest.empty()) return "its header does not end";
        if (line.front() == '#' || equals == std::string_view::npos) continue;
        std::string_view words = line.substr(equals + 1);
        const std::string_view name = line.substr(0, equals);
        const std::vector<double> numbers = numbers_of(words);
        if (name == "FORMAT") {
            const std::string_view format = take_word(words);
            is_xyz = format == "32-bit_rle_xyze";
            if (!is_xyz && format != "32-bit_rle_rgbe") return "its format '" + std::string(format) + "' is unknown";
        } else if (name == "EXPOSURE" && numbers.size() == 1 && numbers[0] > 0) {
            exposure *= numbers[0];  // of each program that scaled the picture
        } else if (name == "COLORCORR" && numbers.size() == 3 && std::min({numbers[0], numbers[1], numbers[2]}) > 0) {
            exposure *= glm::dvec3(numbers[0], numbers[1], numbers[2]);
        } else if (name == "PRIMARIES" && numbers.size() == 8) {
            primaries = to_rec709({{numbers[0], numbers[1]},
                                   {numbers[2], numbers[3]},
                                   {numbers[4], numbers[5]},
                                   {numbers[6], numbers[7]}});
        }
    }
    const glm::dmat3 undo(1 / exposure.x, 0, 0, 0, 1 / exposure.y, 0, 0, 0, 1 / exposure.z);
    header.to_linear = (is_xyz ? to_rec709_from_xyz() : primaries) * undo;
    return {};
}

/// "-Y 512 +X 768": the axis along which scan lines follow each other and their number, then the axis in a line.
bool read_resolution(std::string_view line, RadianceHeader& header) {
    for (int i = 0; i < 2; ++i) {
        const std::string_view axis = take_word(line);
        const std::vector<double> size = numbers_of(take_word(line));
        if (axis.size() != 2 || (axis[0] != '+' && axis[0] != '-') || size.empty()) return false;
        if (!(size[0] >= 1 && size[0] <= 1e9)) return false;
        if (axis[1] == 'X' && header.width == 0)
            header.width = unsigned(size[0]), header.from_right = axis[0] == '-', header.columns = i == 0;
        else if (axis[1] == 'Y' && header.height == 0)
            header.height = unsigned(size[0]), header.from_bottom = axis[0] == '+';
        else
            return false;
    }
    return true;
}

/// Decodes one scan line after the other.
class Lines {
public:
    explicit Lines(std::string_view rest) : rest_(rest) {}

    /// Returns false if the line is cut off, or if its runs are longer than it is. Dark pixels can begin as runs do,
    /// but for the length.
    bool read(std::vector<Rgbe>& line) {
        const bool has_runs = line.size() >= 8 && line.size() < 32768 && rest_.size() >= 4 && at(0) == 2 &&
                              at(1) == 2 && (std::size_t(at(2)) << 8 | at(3)) == line.size();
        return has_runs ? read_runs(line) : read_old(line);
    }

private:
    [[nodiscard]] std::uint8_t at(std::size_t i) const { return std::uint8_t(rest_[i]); }

    /// Each channel in turn: a count above 128 and a value, or a count and as many values.
    bool read_runs(std::vector<Rgbe>& line) {
        rest_.remove_prefix(4);
        for (std::size_t channel = 0; channel < 4; ++channel)
            for (std::size_t x = 0; x < line.size();) {
                if (rest_.empty()) return false;
                const bool is_run = at(0) > 128;
                const std::size_t count = is_run ? at(0) - 128u : at(0), bytes = is_run ? 2 : 1 + count;
                if (count > line.size() - x || rest_.size() < bytes) return false;
                for (std::size_t i = 0; i < count; ++i) line[x++][channel] = at(is_run ? 1 : 1 + i);
                rest_.remove_prefix(bytes);
            }
        return true;
    }

    /// Pixels, of which 1 1 1 n repeats the one before n times. Such pixels in a row are digits of n to the base 256.
    bool read_old(std::vector<Rgbe>& line) {
        unsigned shift = 0;
        for (std::size_t x = 0; x < line.size();) {
            if (rest_.size() < 4) return false;
            const Rgbe pixel{at(0), at(1), at(2), at(3)};
            rest_.remove_prefix(4);
            if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
                line[x++] = pixel, shift = 0;
                continue;
            }
            const std::size_t count = shift < 32 ? std::size_t(pixel[3]) << shift : line.size();
            if (x == 0 || count > line.size() - x) return false;
            for (std::size_t i = 0; i < count; ++i, ++x) line[x] = line[x - 1];
            shift += 8;
        }
        return true;
    }

    std::string_view rest_;
};

}  // namespace

bool is_radiance(std::string_view bytes) { return bytes.starts_with("#?"); }

std::string read_radiance_header(std::string_view bytes, RadianceHeader& header) {
    std::string_view rest = bytes;
    static_cast<void>(take_line(rest));
    if (std::string fault = read_variables(rest, header); !fault.empty()) return fault;
    if (!read_resolution(take_line(rest), header)) return "its line of the size is damaged";
    header.pixels = bytes.size() - rest.size();
    return {};
}

std::string read_radiance_pixels(std::string_view bytes, const RadianceHeader& header, std::vector<float>& rgb) {
    const std::size_t width = header.width, height = header.height;
    rgb.resize(3 * width * height);
    std::vector<Rgbe> line(header.columns ? height : width);
    Lines lines(bytes.substr(header.pixels));
    for (std::size_t j = 0; j < (header.columns ? width : height); ++j) {
        if (!lines.read(line)) return "it is cut off, or its runs are longer than its rows";
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::size_t across = header.columns ? j : i, down = header.columns ? i : j;
            const std::size_t x = header.from_right ? width - 1 - across : across;
            const std::size_t y = header.from_bottom ? height - 1 - down : down;
            const float unit = line[i][3] == 0 ? 0.f : std::ldexp(1.f, int(line[i][3]) - (128 + 8));
            for (std::size_t c = 0; c < 3; ++c) rgb[3 * (y * width + x) + c] = float(line[i][c]) * unit;
        }
    }
    convert_colors(rgb, 3, header.to_linear);
    return {};
}

}  // namespace claray
