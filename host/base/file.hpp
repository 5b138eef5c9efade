// Reads whole files, and writes files so that a partly written one is never visible.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace claray {

/// Stored in files. On a machine of the other byte order it reads as another value.
constexpr std::uint32_t byte_order = 0x01020304;

/// The bytes of a file. Throws ErrorKind::user where it can't be read; `remedy` completes that message.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, const std::string& remedy);

/// Throws what that would, as far as can be told without reading.
void check_file_readable(const std::filesystem::path& path, const std::string& remedy);

/// A file that appears under its name, complete and safe on disk, when `commit` is called, and otherwise never: it is
/// written beside its place and renamed. Links are followed, also those that point to nothing yet; devices, pipes and
/// what this process has open already (/dev/stdout) are written in place. All functions throw ErrorKind::user naming
/// the path.
class NewFile {
public:
    explicit NewFile(const std::filesystem::path& path);
    ~NewFile();
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;

    void write(const void* data, std::size_t bytes);
    void commit();

private:
    void create();

    std::filesystem::path path_, target_, temporary_;  // no temporary file where the target is written in place
    int file_ = -1;
};

/// A whole file as a NewFile; public in claray/io.hpp.
void write_file(const std::filesystem::path& path, const std::string& bytes);

/// Makes a folder and those above it where they are not there yet. Throws ErrorKind::user naming the path.
void make_folder(const std::filesystem::path& path);

/// Where the bytes of a file of this name will be: links are followed, also those that point to nothing yet.
[[nodiscard]] std::filesystem::path write_target(const std::filesystem::path& path);

/// True where what is written to the one name would replace what is written to the other, by whatever links and
/// spelling. Hard links are two files, since each name is replaced by a new file. False for devices such as /dev/null.
[[nodiscard]] bool are_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Throws what writing to this path would, as far as can be told without writing.
void check_file_writable(const std::filesystem::path& path);

}  // namespace claray
