#include "host/io/points/pcd_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "claray/error.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PCD is of the byte order of little-endian machines");

template <class T>
T bytes_as(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

double pcd_number(const char* bytes, char type, std::size_t size) {
    if (type == 'F') return size == 8 ? bytes_as<double>(bytes) : double(bytes_as<float>(bytes));
    const bool is_signed = type == 'I';
    switch (size) {
        case 1: return is_signed ? double(bytes_as<std::int8_t>(bytes)) : double(bytes_as<std::uint8_t>(bytes));
        case 2: return is_signed ? double(bytes_as<std::int16_t>(bytes)) : double(bytes_as<std::uint16_t>(bytes));
        case 4: return is_signed ? double(bytes_as<std::int32_t>(bytes)) : double(bytes_as<std::uint32_t>(bytes));
        default: return is_signed ? double(bytes_as<std::int64_t>(bytes)) : double(bytes_as<std::uint64_t>(bytes));
    }
}

/// A value of a text, as bytes of its field: numbers that the type cannot hold become 0.
void append_value(std::string& bytes, double value, const PcdField& field) {
    const bool real = field.type == 'F';
    const double least = field.type == 'I' ? -std::ldexp(1.0, int(8 * field.size) - 1) : 0;
    const double beyond = std::ldexp(1.0, int(8 * field.size) - (field.type == 'I' ? 1 : 0));
    char raw[8] = {};
    if (real && field.size == 8) {
        std::memcpy(raw, &value, sizeof value);
    } else if (real) {
        const auto single = float(value);
        std::memcpy(raw, &single, sizeof single);
    } else if (value >= least && value < beyond) {
        const std::uint64_t whole = value < 0 ? std::uint64_t(std::int64_t(value)) : std::uint64_t(value);
        std::memcpy(raw, &whole, sizeof whole);
    }
    bytes.append(raw, field.size);
}

bool is_pcd_type(char type, std::size_t size) {
    return type == 'F' ? size == 4 || size == 8
                       : (type == 'I' || type == 'U') && (size == 1 || size == 2 || size == 4 || size == 8);
}

}  // namespace

PcdFile::PcdFile(std::string_view bytes, std::filesystem::path path) : path_(std::move(path)), rest_(bytes) {
    read_header();
    lay_out();
    if (data_ == "ascii")
        read_text();
    else if (data_ == "binary")
        read_binary();
    else if (data_ == "binary_compressed")
        read_compressed();
    else
        refuse("its data are of the unknown form " + claray::quoted(data_));
}

void PcdFile::refuse(const std::string& what) const {
    throw Error(ErrorKind::user, "'" + path_.string() + "' line " + std::to_string(line_) + ": " + what,
                "export the points again");
}

std::string_view PcdFile::next_line() {
    ++line_;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

void PcdFile::read_header() {
    while (data_.empty()) {
        if (rest_.empty()) refuse("the header has no line DATA");
        std::string_view line = next_line();
        const std::string_view key = next_word(line);
        if (!key.empty()) read_header_line(key, line);
    }
}

void PcdFile::read_header_line(std::string_view key, std::string_view rest) {
    constexpr std::size_t most_fields = 1000, most_values = 1 << 16;
    const auto count_in = [&](std::string_view word, double most) {
        const std::optional<double> value = number_in(word);
        if (!value || !(*value >= 0 && *value <= most) || *value != std::floor(*value))
            refuse(quoted(word) + " is no number of " + std::string(key));
        return std::size_t(*value);
    };
    constexpr double most_points = 1e15;
    if (key == "DATA") data_ = next_word(rest);
    if (key == "DATA" && data_.empty()) refuse("DATA names no form");
    if (key == "WIDTH") width_ = count_in(next_word(rest), most_points);
    if (key == "HEIGHT") height_ = count_in(next_word(rest), most_points);
    if (key == "POINTS") points_ = count_in(next_word(rest), most_points);
    if (key == "FIELDS" || key == "COLUMNS") {
        fields_.clear();
        for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
            fields_.push_back({.name = std::string(word)});
        if (fields_.size() > most_fields) refuse("there are more than 1000 fields");
    }
    if (key != "SIZE" && key != "TYPE" && key != "COUNT") return;
    for (PcdField& field : fields_) {
        const std::string_view word = next_word(rest);
        if (word.empty()) refuse(std::string(key) + " has fewer entries than there are fields");
        if (key == "SIZE") field.size = count_in(word, 8);
        if (key == "COUNT") field.count = count_in(word, most_values);
        if (key == "TYPE") field.type = word.size() == 1 ? word[0] : '?';
    }
}

void PcdFile::lay_out() {
    for (PcdField& field : fields_) {
        if (!is_pcd_type(field.type, field.size))
            refuse("the field " + claray::quoted(field.name) + " has a type that no PCD has");
        field.offset = row_bytes_;
        row_bytes_ += field.size * field.count;
    }
    if (row_bytes_ == 0) refuse("the header names no fields");
    if (points_ == 0) {
        if (height_ != 0 && width_ > std::numeric_limits<std::size_t>::max() / height_) refuse("it is too wide");
        points_ = width_ * height_;
    }
}

void PcdFile::read_text() {
    if (points_ > rest_.size()) refuse("there are fewer values than " + std::to_string(points_) + " points have");
    for (std::size_t point = 0; point < points_;) {
        if (rest_.empty()) refuse("the file is cut off after " + std::to_string(point) + " points");
        std::string_view line = next_line();
        if (line.find_first_not_of(" \t") == line.npos) continue;
        for (const PcdField& field : fields_)
            for (std::size_t i = 0; i < field.count; ++i) {
                const std::string_view word = next_word(line);
                const std::optional<double> value = number_in(word);
                if (!value) refuse(word.empty() ? "a value is missing" : quoted(word) + " is not a number");
                append_value(rows_, *value, field);
            }
        ++point;
    }
}

void PcdFile::read_binary() {
    if (points_ > rest_.size() / row_bytes_)
        refuse("the file is cut off: " + std::to_string(points_) + " points need more than " +
               std::to_string(rest_.size()) + " bytes");
    rows_ = rest_.substr(0, points_ * row_bytes_);
}

void PcdFile::read_compressed() {
    if (rest_.size() < 8) refuse("the file is cut off");
    const std::size_t packed = bytes_as<std::uint32_t>(rest_.data()), size = bytes_as<std::uint32_t>(rest_.data() + 4);
    rest_.remove_prefix(8);
    if (packed > rest_.size()) refuse("the file is cut off");
    if (size / row_bytes_ != points_ || size % row_bytes_ != 0)
        refuse("its " + std::to_string(size) + " bytes are not those of " + std::to_string(points_) + " points");
    constexpr std::size_t most_ratio = 140;  // 3 bytes make at most 264
    if (size / most_ratio > packed) refuse("its compressed data are damaged");
    rows_ = lzf_decompressed(rest_.substr(0, packed), size);
    if (rows_.size() != size) refuse("its compressed data are damaged");
    by_field_ = true;
}

const PcdField* PcdFile::field(std::string_view name) const {
    const auto found = std::find_if(fields_.begin(), fields_.end(),
                                    [&](const PcdField& field) { return field.name == name && field.count == 1; });
    return found == fields_.end() ? nullptr : &*found;
}

const char* PcdFile::at(const PcdField& field, std::size_t point) const {
    return rows_.data() + (by_field_ ? points_ * field.offset + point * field.size : point * row_bytes_ + field.offset);
}

double PcdFile::value(const PcdField& field, std::size_t point) const {
    return pcd_number(at(field, point), field.type, field.size);
}

std::uint32_t PcdFile::word(const PcdField& field, std::size_t point) const {
    return field.size == 4 ? bytes_as<std::uint32_t>(at(field, point)) : 0;
}

// A control byte below 32 precedes as many literals and one more. Others have the length of a copy, less 2, in their
// upper three bits; 7 is added to by the next byte. The lower five bits and a byte are its distance, less 1.
std::string lzf_decompressed(std::string_view bytes, std::size_t size) {
    std::string out;
    out.reserve(size);
    std::size_t at = 0;
    const auto next = [&] { return std::size_t(std::uint8_t(bytes[at++])); };
    while (at < bytes.size()) {
        const std::size_t control = next();
        if (control < 32) {
            if (control + 1 > bytes.size() - at || control + 1 > size - out.size()) return {};
            out.append(bytes.substr(at, control + 1));
            at += control + 1;
            continue;
        }
        std::size_t length = control >> 5;
        if (bytes.size() - at < (length == 7 ? 2u : 1u)) return {};
        if (length == 7) length += next();
        const std::size_t distance = ((control & 31) << 8 | next()) + 1;
        if (distance > out.size() || length + 2 > size - out.size()) return {};
        for (std::size_t i = 0; i < length + 2; ++i) out.push_back(out[out.size() - distance]);
    }
    return out;
}

}  // namespace claray
