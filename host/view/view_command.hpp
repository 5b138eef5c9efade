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

/// Throws ErrorKind::user, naming the command and what it takes, for an unknown command, a wrong number of arguments,
/// or a number that is not finite.
[[nodiscard]] ViewCommand parse_command(const std::string& line);

}  // namespace claray::view
