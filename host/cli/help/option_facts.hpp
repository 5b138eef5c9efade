// What the tree of CLI11 knows of an option: help, completions, the man page and jobs are made from it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace claray::cli {

/// The commands of the program, in the order of the help.
[[nodiscard]] std::vector<const CLI::App*> commands_of(const CLI::App& app);
/// The options of a command in the order of their definition, but positional arguments.
[[nodiscard]] std::vector<const CLI::Option*> options_of(const CLI::App& command);
[[nodiscard]] std::vector<const CLI::Option*> positionals_of(const CLI::App& command);

/// "--output", "-o" and all other spellings; negated flags, too.
[[nodiscard]] std::vector<std::string> spellings_of(const CLI::Option& option);
/// "output": the first long name, or that of a positional argument.
[[nodiscard]] std::string key_of(const CLI::Option& option);

/// False for flags, whose values are optional.
[[nodiscard]] bool takes_value(const CLI::Option& option);
/// Whether its value is a number for CLI11, too.
[[nodiscard]] bool is_number(const CLI::Option& option);
/// Whether it takes several values, which commas separate in one.
[[nodiscard]] bool is_list(const CLI::Option& option);
/// Whether it may be repeated.
[[nodiscard]] bool is_repeatable(const CLI::Option& option);

/// Whether its value is a path: its type ends with `file_value`.
[[nodiscard]] bool names_file(const CLI::Option& option);

/// The name of a validator that accepts these names only; `choices_of` reads it. `values`: what it makes of them;
/// empty: nothing else.
[[nodiscard]] std::string choices_name(const std::vector<std::string>& names, const std::vector<int>& values = {});
/// The names that an option accepts; empty: any, or numbers.
[[nodiscard]] std::vector<std::string> choices_of(const CLI::Option& option);

/// The name that became this value of an option; the value itself for others.
[[nodiscard]] std::string choice_named(const CLI::Option& option, const std::string& value);

/// The first statement of a description, and its default.
[[nodiscard]] std::string brief(const std::string& description);

}  // namespace claray::cli
