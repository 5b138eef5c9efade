// The language of a view: what keys, clicks, the web page and scripts say. One command per line, words separated by
// blanks.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace claray::view {

struct ViewCommand {
    std::string name;
    std::string word;            ///< empty unless the command takes one
    std::vector<float> numbers;  ///< as many as the command takes
};

/// A command that exists.
struct CommandRow {
    const char* name;
    const char* word;  ///< what its word is; null: it takes none
    unsigned numbers;
    const char* arguments;  ///< for users
    const char* help;
};
[[nodiscard]] std::span<const CommandRow> view_commands();
/// Returns the words that a command takes if it takes one of a few, such as "none|aces"; else nothing.
[[nodiscard]] std::vector<std::string> choices_of(const CommandRow& row);

/// Throws ErrorKind::user, naming the command and what it takes, for an unknown command or word, a wrong number of
/// arguments, or a number that is not finite.
[[nodiscard]] ViewCommand parse_command(const std::string& line);

}  // namespace claray::view
