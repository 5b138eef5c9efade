// Reads whole files, and writes files so that a partly written one is never visible.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace claray {

/// Stored in files; machines of the other byte order read another value.
constexpr std::uint32_t byte_order = 0x01020304;

/// Returns the bytes of a file. Throws ErrorKind::user if it cannot be read; `remedy` completes the message.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, const std::string& remedy);

/// Throws the errors of read_file that are detectable without reading.
void check_file_readable(const std::filesystem::path& path, const std::string& remedy);

/// A file that appears under its name, complete and synced to disk, only when `commit` is called: it is written to a
/// temporary file in the same folder, which is renamed. Links are followed, including dangling ones; devices, pipes and
/// open files of this process (/dev/stdout) are written in place. All functions throw ErrorKind::user naming the path.
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

    std::filesystem::path path_, target_, temporary_;  // no temporary file if the target is written in place
    int file_ = -1;
};

/// Writes a whole file as a NewFile; public in claray/io.hpp.
void write_file(const std::filesystem::path& path, const std::string& bytes);

/// Creates a folder and its parents if they do not exist. Throws ErrorKind::user naming the path.
void make_folder(const std::filesystem::path& path);

/// The path to which a file of this name is written: links are followed, including dangling ones.
[[nodiscard]] std::filesystem::path write_target(const std::filesystem::path& path);

/// Returns true if writing to one path would replace the other's file, through any links and spelling. Hard links are
/// two files, because each name is replaced by a new file. False for devices such as /dev/null.
[[nodiscard]] bool are_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Returns false if writing to this path appends to what was written before: devices, pipes, /dev/stdout.
[[nodiscard]] bool is_replaced(const std::filesystem::path& path);

/// Throws the errors of writing to this path that are detectable without writing.
void check_file_writable(const std::filesystem::path& path);

}  // namespace claray
