// The texts that `--help` and `--help-all` print.
#pragma once

#include <CLI/CLI.hpp>

namespace claray::cli {

/// Adds `--help-all`, and writes both texts: options by their groups, in lines as wide as the terminal, at most 100
/// columns. `--help` has the groups for every day only, and the first statement of each description.
void set_help(CLI::App& app);

/// A group of options in the help, until it ends: those that are added to a command meanwhile.
class OptionGroup {
public:
    OptionGroup(CLI::App& command, const std::string& name)
        : defaults_(*command.option_defaults()), before_(defaults_.get_group()) {
        defaults_.group(name);
    }
    /// The group of what is added from here on.
    void next(const std::string& name) { defaults_.group(name); }
    ~OptionGroup() { defaults_.group(before_); }
    OptionGroup(const OptionGroup&) = delete;
    OptionGroup& operator=(const OptionGroup&) = delete;

private:
    CLI::OptionDefaults& defaults_;
    const std::string before_;
};

}  // namespace claray::cli
