#include "host/base/message.hpp"

#include <cstdint>

#include "claray/error.hpp"

namespace claray {
namespace {

bool is_continuation(char c) { return (std::uint8_t(c) & 0xc0) == 0x80; }

/// Length of the UTF-8 character at the beginning of a text (RFC 3629); 0 if it is invalid. Overlong forms, surrogates
/// and values above U+10FFFF are invalid.
std::size_t character_bytes(std::string_view text) {
    const auto first = std::uint8_t(text[0]);
    if (first < 0x80) return 1;
    const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4 || text.size() < bytes) return 0;
    for (std::size_t i = 1; i < bytes; ++i)
        if (!is_continuation(text[i])) return 0;
    const auto second = std::uint8_t(text[1]);
    if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) || (first == 0xf0 && second < 0x90) ||
        (first == 0xf4 && second > 0x8f))
        return 0;
    return bytes;
}

std::uint32_t code_point(std::string_view character) {
    constexpr std::uint32_t first_bits[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
    std::uint32_t code = std::uint8_t(character[0]) & first_bits[character.size()];
    for (const char c : character.substr(1)) code = code << 6 | (std::uint8_t(c) & 0x3f);
    return code;
}

/// ASCII and Latin-1 control characters, line and paragraph breaks, direction marks.
bool is_control(std::uint32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x200e || code == 0x200f ||
           (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

/// `kept`: ASCII control characters to keep.
std::string printable(std::string_view text, std::string_view kept) {
    std::string result;
    while (!text.empty()) {
        const std::size_t bytes = character_bytes(text);
        const bool stays = bytes > 0 && (kept.find(text[0]) != std::string_view::npos ||
                                         !is_control(code_point(text.substr(0, bytes))));
        if (stays)
            result += text.substr(0, bytes);
        else
            result += '?';
        text.remove_prefix(bytes > 0 ? bytes : 1);
    }
    return result;
}

}  // namespace

std::string one_line(std::string_view text, std::size_t most) {
    constexpr std::string_view gap = "...";
    // Text that is cut is not examined: a file may contain a line of a gigabyte.
    const bool is_huge = text.size() > 8 * most;
    const std::string head = printable(is_huge ? text.substr(0, 4 * most) : text, "");
    const std::string tail = is_huge ? printable(text.substr(text.size() - 4 * most), "") : head;
    if (!is_huge && head.size() <= most) return head;
    std::size_t end = (most - gap.size()) * 2 / 3, begin = tail.size() - (most - gap.size() - end);
    while (end > 0 && is_continuation(head[end])) --end;
    while (begin < tail.size() && is_continuation(tail[begin])) ++begin;
    return head.substr(0, end).append(gap).append(tail, begin);
}

std::string many_lines(std::string_view text) { return printable(text, "\n\t"); }

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text)
        out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
    return out;
}

Error::Error(ErrorKind kind, const std::string& message, const std::string& remedy, const std::string& report)
    : std::runtime_error(one_line(remedy.empty() ? message : message + "; " + remedy) +
                         (report.empty() ? std::string() : '\n' + many_lines(report))),
      kind_(kind) {}

}  // namespace claray
