#include "host/cli/options/usage_error.hpp"

#include <algorithm>

#include "claray/error.hpp"

namespace claray::cli {
namespace {

/// What no option and no argument takes: the first of it.
std::string unexpected(const CLI::App& command) {
    const std::vector<std::string> words = command.remaining();
    const std::string word = words.empty() ? "?" : words.front();
    return word.starts_with('-') ? "unknown option '" + word + "'" : "'" + word + "' is an unexpected argument";
}

/// "--output: 1 required TEXT missing" -> "--output"
std::string option_of(const CLI::ParseError& error) {
    const std::string text = error.what();
    return text.substr(0, std::min(text.find(": "), text.find(' ')));
}

std::string what_is_wrong(const CLI::App& command, const CLI::ParseError& error) {
    // What is missing may be what a misspelt option was to give.
    const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    if (dynamic_cast<const CLI::ExtrasError*>(&error) || (missing && !command.remaining().empty()))
        return unexpected(command);
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error))
        return option_of(error) + (std::string(error.what()).find("At Most") != std::string::npos
                                       ? " is given more than once"
                                       : " needs a value");
    if (dynamic_cast<const CLI::ConversionError*>(&error) && option_of(error).starts_with('-'))
        return option_of(error) + " does not accept this value";
    return error.what();
}

}  // namespace

std::string usage_error(const CLI::App& app, int argc, char** argv, const CLI::ParseError& error) {
    const std::vector<CLI::App*> commands = app.get_subcommands();
    const bool any = !commands.empty();
    if (!any && argc > 1 && argv[1][0] != '-')
        return "unknown command '" + std::string(argv[1]) + "'; see claray --help";
    return what_is_wrong(any ? *commands.front() : app, error) + "; see claray " +
           (any ? commands.front()->get_name() + " " : std::string()) + "--help";
}

void refuse_empty_values(const CLI::App& app) {
    for (const CLI::App* command : app.get_subcommands())
        for (const CLI::Option* option : command->get_options())
            for (const std::string& value : option->results())
                if (value.empty() && option->get_expected_max() > 0)
                    throw Error(ErrorKind::usage, option->get_name() + " has an empty value",
                                "give a value, or leave the option out");
}

}  // namespace claray::cli
