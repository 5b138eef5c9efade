#include "host/cli/help/option_facts.hpp"

#include <algorithm>

#include "host/cli/options/option_rules.hpp"

namespace claray::cli {
namespace {

constexpr const char* choices_mark = "choices:";

/// "NAME=VALUE" of each choice, or "NAME".
std::vector<std::string> entries_of(const CLI::Option& option) {
    auto& any = const_cast<CLI::Option&>(option);  // CLI11 2.1 shows no validators of const ones
    try {
        for (int i = 0;; ++i) {
            const std::string name = any.get_validator(i)->get_name();
            if (name.starts_with(choices_mark)) return split(name.substr(std::string_view(choices_mark).size()));
        }
    } catch (const CLI::OptionNotFound&) {  // after the last
        return {};
    }
}

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands({}); }

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
    return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& command) {
    return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<std::string> spellings_of(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    return names;
}

std::string key_of(const CLI::Option& option) {
    return option.get_lnames().empty() ? option.get_single_name() : option.get_lnames().front();
}

bool takes_value(const CLI::Option& option) { return option.get_expected_max() > 0; }

bool is_number(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    return takes_value(option) && (type == "FLOAT" || type == "INT" || type == "UINT");
}

bool is_list(const CLI::Option& option) { return option.get_delimiter() == ','; }

bool is_repeatable(const CLI::Option& option) {
    return option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll ||
           option.get_expected_max() >= CLI::detail::expected_max_vector_size;
}

bool names_file(const CLI::Option& option) { return option.get_type_name().ends_with(file_value); }

std::string choices_name(const std::vector<std::string>& names, const std::vector<int>& values) {
    std::vector<std::string> entries = names;
    for (std::size_t i = 0; i < values.size(); ++i) entries[i] += "=" + std::to_string(values[i]);
    return choices_mark + CLI::detail::join(entries);
}

std::vector<std::string> choices_of(const CLI::Option& option) {
    std::vector<std::string> names = entries_of(option);
    for (std::string& name : names) name = name.substr(0, name.find('='));
    return names;
}

std::string choice_named(const CLI::Option& option, const std::string& value) {
    for (const std::string& entry : entries_of(option))
        if (entry.ends_with("=" + value)) return entry.substr(0, entry.find('='));
    return value;
}

std::string brief(const std::string& description) {
    std::size_t end = 0;
    for (int depth = 0; end < description.size(); ++end) {
        const std::string_view rest = std::string_view(description).substr(end);
        depth += rest[0] == '(' || rest[0] == '[' ? 1 : rest[0] == ')' || rest[0] == ']' ? -1 : 0;
        if (depth == 0 && (rest[0] == '\n' || rest.starts_with("; ") || rest.starts_with(". "))) break;
    }
    std::string text = description.substr(0, end);
    while (text.ends_with(':') || text.ends_with('.')) text.pop_back();
    const std::size_t bracket = description.rfind('[');
    if (description.ends_with(']') && bracket >= end) text += " " + description.substr(bracket);
    return text;
}

}  // namespace claray::cli
