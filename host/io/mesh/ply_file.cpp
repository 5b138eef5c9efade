#include "host/io/mesh/ply_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

#include "claray/error.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

using std::to_string;

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Takes the next word away from `rest`; empty if there is none.
std::string_view take_ply_word(std::string_view& rest) {
    std::size_t begin = 0;
    while (begin < rest.size() && is_blank(rest[begin])) ++begin;
    std::size_t end = begin;
    while (end < rest.size() && !is_blank(rest[end])) ++end;
    const std::string_view word = rest.substr(begin, end - begin);
    rest.remove_prefix(end);
    return word;
}

struct TypeName {
    std::string_view name, other;
    PlyType type;
    unsigned bytes;
};
constexpr TypeName types[] = {{"char", "int8", PlyType::int8, 1},        {"uchar", "uint8", PlyType::uint8, 1},
                              {"short", "int16", PlyType::int16, 2},     {"ushort", "uint16", PlyType::uint16, 2},
                              {"int", "int32", PlyType::int32, 4},       {"uint", "uint32", PlyType::uint32, 4},
                              {"float", "float32", PlyType::float32, 4}, {"double", "float64", PlyType::float64, 8}};

unsigned bytes_of(PlyType type) { return types[std::size_t(type)].bytes; }

template <class T>
double read_as(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    return double(std::bit_cast<T>(raw));
}

double read_binary(PlyType type, const char* bytes, bool swap) {
    switch (type) {
        case PlyType::int8: return read_as<std::int8_t>(bytes, swap);
        case PlyType::uint8: return read_as<std::uint8_t>(bytes, swap);
        case PlyType::int16: return read_as<std::int16_t>(bytes, swap);
        case PlyType::uint16: return read_as<std::uint16_t>(bytes, swap);
        case PlyType::int32: return read_as<std::int32_t>(bytes, swap);
        case PlyType::uint32: return read_as<std::uint32_t>(bytes, swap);
        case PlyType::float32: return read_as<float>(bytes, swap);
        default: return read_as<double>(bytes, swap);
    }
}

}  // namespace

int PlyElement::find(std::initializer_list<std::string_view> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
        for (const std::string_view name : names)
            if (is_same_in_any_case(name, properties[i].name)) return int(i);
    return -1;
}

PlyReader::PlyReader(std::string_view bytes, std::filesystem::path path) : bytes_(bytes), path_(std::move(path)) {
    read_header();
}

std::string PlyReader::place() const {
    if (reading_ == nullptr || format_ == Format::text) return "line " + to_string(line_);
    return "element '" + reading_->name + "', row " + to_string(row_);
}

void PlyReader::refuse(const std::string& what, const std::string& remedy) const {
    throw Error(ErrorKind::user, "'" + path_.string() + "' " + place() + ": " + what, remedy);
}

std::string_view PlyReader::next_line() {
    if (left() == 0) refuse("the file ends within its header", "export the mesh again");
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    const std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end;
    if (left() >= 2 && bytes_.substr(at_, 2) == "\r\n")
        at_ += 2;
    else if (left() != 0)
        ++at_;
    ++line_;
    return line;
}

void PlyReader::read_header() {
    if (bytes_.starts_with("\xef\xbb\xbf")) at_ = 3;
    std::string_view first = next_line();
    if (take_ply_word(first) != "ply") refuse("the file does not begin with 'ply'", "convert it to PLY, OBJ or glTF");
    bool has_format = false;
    for (;;) {
        std::string_view line = next_line(), rest = line;
        const std::string_view word = take_ply_word(rest);
        if (word == "end_header") break;
        if (word == "format") {
            const std::string_view name = take_ply_word(rest);
            if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
                refuse("unknown format '" + std::string(name) + "'", "use ascii or binary_little_endian");
            format_ = name == "ascii" ? Format::text : name == "binary_big_endian" ? Format::big : Format::little;
            has_format = true;
            continue;
        }
        read_header_line(line);
    }
    if (!has_format) refuse("the header has no line 'format'", "export the mesh again");
    ++line_;  // where the first row is
    for (const PlyElement& element : elements_) check_size(element);
    if (format_ == Format::text) find_lines_of_rows();
}

/// The format wants a line for each row. Some writers break rows over several lines, or have them all in one.
void PlyReader::find_lines_of_rows() {
    std::uint64_t rows = 0, lines = 0;
    for (const PlyElement& element : elements_) rows += element.count;
    bool blank = true;
    for (const char c : bytes_.substr(at_)) {
        lines += c == '\n' && !blank;
        blank = c == '\n' || (blank && is_blank(c));
    }
    lines += !blank;
    rows_ = lines == rows ? Rows::on_a_line : lines > rows ? Rows::from_a_line_on : Rows::anywhere;
}

/// What is left of the line of a row.
void PlyReader::end_line() {
    if (is_line_over()) return;
    if (long_lines_.count++ == 0) long_lines_.line = line_;
    at_ = std::min(bytes_.find('\n', at_), bytes_.size());
}

void PlyReader::read_header_line(std::string_view line) {
    const std::string_view word = take_ply_word(line);
    if (word == "comment") return read_comment(line);
    if (word == "obj_info" || word.empty()) return;
    if (word == "element") return add_element(line);
    if (word == "property") return add_property(line);
    if (elements_.empty()) return;  // "Created by", by old versions of Blender
    refuse("unknown statement '" + std::string(word) + "' in the header", "export the mesh again");
}

void PlyReader::read_comment(std::string_view rest) {
    if (!is_same_in_any_case(take_ply_word(rest), "TextureFile")) return;
    const std::size_t begin = rest.find_first_not_of(" \t"), end = rest.find_last_not_of(" \t");
    if (begin != std::string_view::npos) images_.emplace_back(rest.substr(begin, end + 1 - begin));
}

void PlyReader::add_element(std::string_view rest) {
    PlyElement element;
    element.name = take_ply_word(rest);
    const std::string_view count = take_ply_word(rest);
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || end != count.data() + count.size())
        refuse("'" + std::string(count) + "' is not a number of elements", "write: element vertex 8");
    constexpr std::size_t most = 64;  // of elements and of properties: more are no mesh
    if (elements_.size() >= most) refuse("more than 64 elements", "export the mesh again");
    elements_.push_back(std::move(element));
}

void PlyReader::add_property(std::string_view rest) {
    const auto type_called = [&](std::string_view name) {
        for (const TypeName& type : types)
            if (name == type.name || name == type.other) return type.type;
        refuse("unknown type '" + std::string(name) + "'",
               "use char, uchar, short, ushort, int, uint, float or double");
    };
    if (elements_.empty()) refuse("a property precedes the first element", "export the mesh again");
    PlyProperty property;
    std::string_view word = take_ply_word(rest);
    property.list = word == "list";
    if (property.list) {
        property.count_type = type_called(take_ply_word(rest));
        word = take_ply_word(rest);
    }
    property.type = type_called(word);
    property.name = take_ply_word(rest);
    if (property.name.empty()) refuse("a property has no name", "write: property float x");
    constexpr std::size_t most = 256;
    if (elements_.back().properties.size() >= most) refuse("more than 256 properties", "export the mesh again");
    elements_.back().properties.push_back(std::move(property));
}

/// So that a few broken bytes cannot ask for gigabytes.
void PlyReader::check_size(const PlyElement& element) {
    std::uint64_t least = 0;
    for (const PlyProperty& p : element.properties)
        least += format_ == Format::text ? 1 : bytes_of(p.list ? p.count_type : p.type);
    if (least == 0 ? element.count != 0 : element.count > left() / least)
        refuse("the file is cut off: " + to_string(element.count) + " rows of element '" + element.name +
                   "' do not fit into it",
               "export the mesh again");
}

void PlyReader::skip_blanks() {
    while (left() != 0 && is_blank(bytes_[at_])) line_ += bytes_[at_++] == '\n';
}

bool PlyReader::is_line_over() {
    while (left() != 0 && bytes_[at_] != '\n' && is_blank(bytes_[at_])) ++at_;
    return left() == 0 || bytes_[at_] == '\n';
}

std::string_view PlyReader::next_word() {
    skip_blanks();
    const std::size_t begin = at_;
    while (left() != 0 && !is_blank(bytes_[at_])) ++at_;
    return bytes_.substr(begin, at_ - begin);
}

double PlyReader::read_value(PlyType type) {
    if (format_ == Format::text) {
        if (rows_ == Rows::on_a_line && is_line_over() && left() != 0)
            refuse("the row lacks values", "export the mesh again");
        const std::string_view word = next_word();
        if (word.empty()) refuse("the file is cut off in element '" + reading_->name + "'", "export the mesh again");
        const std::optional<double> value = number_in(word);
        if (!value) refuse(claray::quoted(word) + " is not a number", "write numbers as in -1.5 or 2e-3");
        return *value;
    }
    const unsigned bytes = bytes_of(type);
    if (left() < bytes) refuse("the file is cut off", "export the mesh again");
    const bool little = std::endian::native == std::endian::little;
    const double value = read_binary(type, bytes_.data() + at_, (format_ == Format::little) != little);
    at_ += bytes;
    return value;
}

void PlyReader::read_row(const PlyElement& element, std::vector<double>& values,
                         std::vector<std::vector<double>>& lists) {
    row_ = reading_ == &element ? row_ + 1 : 0;
    reading_ = &element;
    const bool by_lines = format_ == Format::text && rows_ != Rows::anywhere;
    if (by_lines) skip_blanks();
    values.assign(element.properties.size(), 0);
    lists.resize(element.properties.size());
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (!property.list) {
            values[i] = read_value(property.type);
            continue;
        }
        const double count = read_value(property.count_type);
        const std::size_t least = format_ == Format::text ? 1 : bytes_of(property.type);
        if (!(count >= 0 && count <= double(left() / least + 1)))
            refuse("a list has " + to_string(std::int64_t(std::clamp(count, -1.0, 1e15))) + " values",
                   "export the mesh again");
        lists[i].clear();
        for (std::uint64_t k = 0; k < std::uint64_t(count); ++k) lists[i].push_back(read_value(property.type));
    }
    if (by_lines) end_line();
}

}  // namespace claray
