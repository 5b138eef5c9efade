// The Point Cloud Data format of PCL, version 0.7: https://pointclouds.org/documentation/tutorials/pcd_file_format.html
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

struct PcdField {
    std::string name;
    char type = 'F';         ///< I, U or F
    std::size_t size = 4;    ///< bytes of a value
    std::size_t count = 1;   ///< values of a point
    std::size_t offset = 0;  ///< in the row of a point
};

/// The points of a file, as binary rows. All functions throw ErrorKind::user, naming the file and the place.
class PcdFile {
public:
    PcdFile(std::string_view bytes, std::filesystem::path path);

    [[nodiscard]] std::size_t points() const { return points_; }
    /// Null: the file has no such field, or one of several values.
    [[nodiscard]] const PcdField* field(std::string_view name) const;
    [[nodiscard]] double value(const PcdField& field, std::size_t point) const;
    /// The bits of a field of four bytes, such as packed colours.
    [[nodiscard]] std::uint32_t word(const PcdField& field, std::size_t point) const;

    [[noreturn]] void refuse(const std::string& what) const;

private:
    [[nodiscard]] std::string_view next_line();
    void read_header();
    void read_header_line(std::string_view key, std::string_view rest);
    void lay_out();
    void read_text();
    void read_binary();
    void read_compressed();
    [[nodiscard]] const char* at(const PcdField& field, std::size_t point) const;

    std::filesystem::path path_;
    std::string_view rest_;
    std::size_t line_ = 0;
    std::vector<PcdField> fields_;
    std::size_t points_ = 0, width_ = 0, height_ = 1, row_bytes_ = 0;
    std::string data_;
    std::string rows_;  ///< all fields of a point one behind the other; if by_field_, all points of a field
    bool by_field_ = false;
};

/// Decompresses LZF (Lehmann). Returns nothing if the bytes are damaged, or do not make `size` bytes.
[[nodiscard]] std::string lzf_decompressed(std::string_view bytes, std::size_t size);

}  // namespace claray
