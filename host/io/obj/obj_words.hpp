// The words of an OBJ's lines, checked: tinyobjloader reads what is no number as 0.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace claray {

/// The next word of a line, which loses it; empty at the end of the line and where a comment begins.
[[nodiscard]] std::string_view next_word(std::string_view& line);

/// A word of a file that may hold anything, fit for one line of a message: at most so many of its characters.
[[nodiscard]] std::string quoted(std::string_view word, std::size_t most = 40);

/// "1", "-.5", "2.e-3".
[[nodiscard]] bool is_finite_number(std::string_view word);
/// nan and inf, with what systems add to them ("-nan(ind)", "1.#QNAN"); none where the word is anything else.
[[nodiscard]] std::optional<float> not_finite_number(std::string_view word);

/// One corner of a face as it is written: counted from 1 or, backwards, from -1; 0 where nothing is given.
struct ObjIndices {
    int position = 0, uv = 0, normal = 0;
};
/// "1", "1/2", "1//3", "1/2/3", "1/", "1/2/"; none where the word is anything else or an index is beyond 2^31 - 1.
[[nodiscard]] std::optional<ObjIndices> parse_corner(std::string_view word);

}  // namespace claray
