// Text files of other programs: encodings, line ends, and what is no text at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace claray {

/// Throws ErrorKind::user, naming the file and what it is, where its first bytes are those of UTF-16, UTF-32 or of an
/// archive (gzip, zip, bzip2, xz, zstd, 7z).
void refuse_other_encodings(std::string_view bytes, const std::filesystem::path& path);

/// UTF-8 or any other text of single bytes. A byte order mark is taken away, and lines end in '\n', whether they ended
/// in
/// "\r\n" (Windows), '\r' (old Macs) or '\n'. Throws as refuse_other_encodings does; `path`: in its message.
[[nodiscard]] std::string text_of(std::string bytes, const std::filesystem::path& path);

/// The text of a file. Throws as read_file and text_of do.
[[nodiscard]] std::string read_text(const std::filesystem::path& path, const std::string& remedy);

/// Joins each line that ends in a backslash with the next, unless it is a comment ("# C:\models\"). Line breaks that
/// are taken away follow the joined line, so that the numbers of later lines stay.
[[nodiscard]] std::string with_joined_lines(std::string_view text);

/// True where a line is one comment, which a backslash does not continue.
[[nodiscard]] bool is_comment(std::string_view line);

}  // namespace claray
