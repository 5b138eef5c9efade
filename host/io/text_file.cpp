#include "host/io/text_file.hpp"

#include <algorithm>
#include <utility>

#include "claray/error.hpp"
#include "host/base/file.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

struct Signature {
    std::string_view bytes;
    const char* name;
    const char* remedy;
};
constexpr const char *unpack = "unpack it first", *as_utf8 = "save it as UTF-8";
constexpr Signature signatures[] = {
    {{"\xff\xfe\0\0", 4}, "text in UTF-32", as_utf8},
    {{"\0\0\xfe\xff", 4}, "text in UTF-32", as_utf8},
    {"\xff\xfe", "text in UTF-16", as_utf8},
    {"\xfe\xff", "text in UTF-16", as_utf8},
    {"\x1f\x8b", "compressed by gzip", unpack},
    {"PK\x03\x04", "a zip archive", unpack},
    {"BZh", "compressed by bzip2", unpack},
    {{"\xfd"
      "7zXZ\0",
      6},
     "compressed by xz",
     unpack},
    {"\x28\xb5\x2f\xfd", "compressed by zstd", unpack},
    {"7z\xbc\xaf\x27\x1c", "a 7z archive", unpack},
};

/// Letters of ASCII in UTF-16 have a zero in every second byte.
bool is_utf16_without_mark(std::string_view bytes) {
    if (bytes.size() < 4) return false;
    const auto zero = [&](std::size_t i) { return bytes[i] == '\0'; };
    return zero(0) == zero(2) && zero(1) == zero(3) && zero(0) != zero(1);
}

void normalize_line_ends(std::string& text) {
    std::size_t kept = text.find('\r');
    if (kept == std::string::npos) return;
    for (std::size_t i = kept; i < text.size(); ++i) {
        const bool ends_line = text[i] == '\r';
        text[kept++] = ends_line ? '\n' : text[i];
        if (ends_line && i + 1 < text.size() && text[i + 1] == '\n') ++i;
    }
    text.resize(kept);
}

}  // namespace

void refuse_other_encodings(std::string_view bytes, const fs::path& path) {
    const auto refuse = [&](const std::string& name, const char* remedy) {
        throw Error(ErrorKind::user, "'" + path.string() + "' is " + name, remedy);
    };
    for (const Signature& signature : signatures)
        if (bytes.starts_with(signature.bytes)) refuse(signature.name, signature.remedy);
    if (is_utf16_without_mark(bytes)) refuse("text in UTF-16", as_utf8);
}

std::string text_of(std::string bytes, const fs::path& path) {
    refuse_other_encodings(bytes, path);
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (bytes.starts_with(mark)) bytes.erase(0, mark.size());
    normalize_line_ends(bytes);
    return bytes;
}

std::string read_text(const fs::path& path, const std::string& remedy) {
    return text_of(read_file(path, remedy), path);
}

bool is_comment(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t");
    return first != std::string_view::npos && line[first] == '#';
}

std::string with_joined_lines(std::string_view text) {
    std::string result;
    std::size_t joined = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const bool goes_on = line.ends_with('\\') && !text.empty() && !(joined == 0 && is_comment(line));
        if (goes_on) line.remove_suffix(1);
        result += line;
        if (goes_on) {
            result += ' ';
            ++joined;
        } else {
            result.append(1 + std::exchange(joined, 0), '\n');
        }
    }
    return result;
}

}  // namespace claray
