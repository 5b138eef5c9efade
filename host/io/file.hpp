// Files as a whole: read one, write one so that there is never half of it.
#pragma once

#include <filesystem>
#include <string>

namespace claray {

/// The bytes of a file. Throws ErrorKind::user where it can't be read; `remedy` completes that message.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, const std::string& remedy);

/// Throws what write_file would for this path as far as can be told without writing.
void check_file_writable(const std::filesystem::path& path);

}  // namespace claray
