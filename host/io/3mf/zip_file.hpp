// Archives in memory (PKWARE's APPNOTE 6.3), stored or deflated, as 3MF files are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

class ZipFile {
public:
    /// Reads the directory. `bytes` must outlive the archive. Throws ErrorKind::user, naming the file.
    ZipFile(std::string_view bytes, std::filesystem::path path);

    /// The content of a part: its name in any case, with or without a slash before it. Nothing if there is none. Throws
    /// if it is damaged; no memory is taken that its bytes cannot fill.
    [[nodiscard]] std::optional<std::string> read(std::string_view name) const;

    [[noreturn]] void refuse(const std::string& what) const;

private:
    struct Part {
        std::string name;
        std::uint32_t method = 0;
        std::size_t packed = 0, size = 0, header = 0;
    };

    [[nodiscard]] std::size_t word(std::size_t at, std::size_t bytes) const;
    void read_directory(std::size_t end);
    void read_large_sizes(Part& part, std::size_t begin, std::size_t end) const;
    [[nodiscard]] std::string_view packed_bytes(const Part& part) const;
    [[nodiscard]] std::string inflated(std::string_view packed, std::size_t size, const std::string& name) const;

    std::string_view bytes_;
    std::filesystem::path path_;
    std::vector<Part> parts_;
};

}  // namespace claray
