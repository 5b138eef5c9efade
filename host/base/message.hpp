// Text that is safe to show: messages of one line on a terminal, and text in markup.
#pragma once

#include <string>
#include <string_view>

namespace claray {

/// Limit of a message so that it has at most 300 bytes with the program's prefix.
inline constexpr std::size_t longest_message = 280;

/// Replaces each control character, invalid UTF-8 byte, Unicode line break and direction mark of `text` by '?'. If it
/// is longer than `most` bytes, "..." replaces its middle: the beginning says what failed and where, the end what to
/// do.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t most = longest_message);

/// The same for a report of several lines: line breaks and tabs are kept, and nothing is cut.
[[nodiscard]] std::string many_lines(std::string_view text);

/// For SVG, HTML and XML: between tags or in quotation marks.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace claray
