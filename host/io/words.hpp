// The words of text files: names in messages, and numbers, which parsers of others read as 0 where they are none.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace claray {

/// ASCII letters in lower case, in any locale; other bytes as they are.
[[nodiscard]] constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }
[[nodiscard]] inline std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = lower_case(c);
    return lower;
}
[[nodiscard]] inline bool is_same_in_any_case(std::string_view a, std::string_view b) {
    return lower_case(a) == lower_case(b);
}

/// The next word of a line, which loses it; empty at the end of the line and where a comment begins.
[[nodiscard]] std::string_view next_word(std::string_view& line);

/// A word of a file that may hold anything, fit for one line of a message: at most so many of its characters.
[[nodiscard]] std::string quoted(std::string_view word, std::size_t most = 40);

/// "1", "-.5", "2.e-3".
[[nodiscard]] bool is_finite_number(std::string_view word);
/// nan and inf, with what systems add to them ("-nan(ind)", "1.#QNAN"); none where the word is anything else.
[[nodiscard]] std::optional<float> not_finite_number(std::string_view word);

/// The value of a number, finite or not; infinite where it is beyond the range of a double. Nothing where the word is
/// no number.
[[nodiscard]] std::optional<double> number_in(std::string_view word);

}  // namespace claray
