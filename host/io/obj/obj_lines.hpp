// The lines of an OBJ, as tinyobjloader asks for them, and what it passes over.
#pragma once

#include <array>
#include <functional>
#include <streambuf>
#include <string>
#include <string_view>

namespace claray {

/// Without blanks at its ends.
[[nodiscard]] std::string_view trim(std::string_view text);

/// Statements that are left out, of one kind: how many, and the first.
struct ObjLeftOut {
    std::size_t count = 0, line = 0;
    std::string keyword;

    void add(std::string_view word, std::size_t at) {
        if (count++ == 0) line = at, keyword = word;
    }
};

/// What a keyword at the beginning of a line asks for.
enum class ObjStatement { known, stroke, free_form, smoothing, unknown };

/// Hands a text to tinyobjloader line by line, so that callbacks know where they are. Lines that end in a backslash are
/// joined with the next one, as the format asks for and the parser does not do.
class ObjLines : public std::streambuf {
public:
    explicit ObjLines(std::string text) : text_(std::move(text)) {}

    /// Counted from 1; of joined lines the last.
    [[nodiscard]] std::size_t line() const { return line_; }
    /// The text of the current line, with its end.
    [[nodiscard]] std::string_view text() const { return {eback(), std::size_t(egptr() - eback())}; }

    /// A line with the name of a vertex's numbers and none of them, which the parser skips.
    struct Bare {
        std::string keyword;
        std::size_t line = 0;
    };
    /// The first such line.
    [[nodiscard]] const Bare& bare() const { return bare_; }
    /// Is called at each line of lines or points, which the parser skips. All lines before were parsed.
    std::function<void()> at_stroke;

    /// What the parser skips without a word.
    [[nodiscard]] const ObjLeftOut& left_out(ObjStatement kind) const { return left_out_[std::size_t(kind)]; }

protected:
    int_type underflow() override;

private:
    // Moves past the end of a line that began at `begin`. True where a backslash, which it blanks, joins it with the
    // next.
    bool join_next_line(std::size_t begin, bool may_go_on);

    std::string text_;
    std::size_t next_ = 0, line_ = 0;
    Bare bare_;
    std::array<ObjLeftOut, 5> left_out_;
};

}  // namespace claray
