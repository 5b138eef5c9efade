// Messages to the user: one line, safe to print on a terminal.
#pragma once

#include <string>
#include <string_view>

namespace claray {

/// With what the program puts before it, a message has at most 300 bytes.
inline constexpr std::size_t longest_message = 280;

/// `text` with '?' for each control character and each byte that is no UTF-8. Where it is longer than `most` bytes,
/// "..." takes the place of its middle: the beginning tells what failed and where, the end what to do. Also replaced
/// are the line breaks of Unicode and the marks that change the direction of text.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t most = longest_message);

/// The same of a report of many lines: line breaks and tabs stay, and nothing is cut.
[[nodiscard]] std::string many_lines(std::string_view text);

}  // namespace claray
