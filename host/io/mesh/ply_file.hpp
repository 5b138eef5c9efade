// The Polygon File Format (Turk 1994; PLY), text and binary: elements with properties, read one row after the other. No
// library of Debian reads it on its own, and Assimp's reader has had memory errors (CVE-2024-40724, CVE-2024-48423).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    bool list = false;
    PlyType count_type = PlyType::uint8;  ///< of the number of a list's values
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// The index of the first property with one of these names, in any case, or -1.
    [[nodiscard]] int find(std::initializer_list<std::string_view> names) const;
};

/// Reads the elements of a PLY in the order of its header. All functions throw ErrorKind::user, naming the file and the
/// line or the element.
class PlyReader {
public:
    /// Reads the header. `bytes` must outlive the reader.
    PlyReader(std::string_view bytes, std::filesystem::path path);

    [[nodiscard]] const std::vector<PlyElement>& elements() const { return elements_; }
    /// What follows "comment TextureFile", as MeshLab writes it.
    [[nodiscard]] const std::vector<std::string>& images() const { return images_; }

    /// Lines of a text that go on behind the values of their row, which are left out: how many, and the first.
    struct LongLines {
        std::size_t count = 0, line = 0;
    };
    [[nodiscard]] const LongLines& long_lines() const { return long_lines_; }

    /// Reads the next row of `element`: one value for each property, 0 for lists, and the values of each list.
    void read_row(const PlyElement& element, std::vector<double>& values, std::vector<std::vector<double>>& lists);

    [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;

private:
    enum class Format { text, little, big };

    void read_header();
    void read_header_line(std::string_view line);
    void read_comment(std::string_view rest);
    void add_element(std::string_view rest);
    void add_property(std::string_view rest);
    void check_size(const PlyElement& element);
    void find_lines_of_rows();
    void end_line();
    void skip_blanks();
    [[nodiscard]] bool is_line_over();  ///< moves to its end, if only blanks follow
    [[nodiscard]] std::string_view next_line();
    [[nodiscard]] std::string_view next_word();
    [[nodiscard]] double read_value(PlyType type);
    [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
    [[nodiscard]] std::string place() const;

    std::string_view bytes_;
    std::filesystem::path path_;
    std::vector<PlyElement> elements_;
    std::vector<std::string> images_;
    Format format_ = Format::text;
    enum class Rows { anywhere, from_a_line_on, on_a_line } rows_ = Rows::anywhere;  ///< of a text
    LongLines long_lines_;
    std::size_t at_ = 0, line_ = 0;
    const PlyElement* reading_ = nullptr;
    std::uint64_t row_ = 0;
};

}  // namespace claray
