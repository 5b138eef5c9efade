#include "host/cli/help/help.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "host/cli/help/option_facts.hpp"

namespace claray::cli {
namespace {

/// The groups of `--help`; `Options` is the group of options that are in no other.
constexpr const char* groups_of_every_day[] = {"Options", "Output",    "Camera", "Light",
                                               "Quality", "Animation", "Device"};

constexpr std::size_t widest = 100, left_column = 28;

std::size_t line_width() {
    struct winsize size = {};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 2 * left_column) return widest;
    return std::min<std::size_t>(size.ws_col, widest);
}

/// The words of `text`, in lines behind `column` blanks; the first line begins at `at`. Its own ends of lines stay.
std::string wrapped(const std::string& text, std::size_t column, std::size_t at) {
    const std::string margin = "\n" + std::string(column, ' ');
    std::string out = at < column || column == 0 ? std::string(column - at, ' ') : margin;
    std::istringstream lines(text);
    bool first_line = true;
    for (std::string line; std::getline(lines, line); first_line = false) {
        if (!first_line) out += margin;
        std::size_t place = column;
        std::istringstream words(line);
        for (std::string word; words >> word; place += word.size()) {
            if (place > column && place + 1 + word.size() > line_width()) out += margin, place = column;
            if (place > column) out += ' ', ++place;
            out += word;
        }
    }
    return out + "\n";
}

std::string help_row(const std::string& left, const std::string& text) {
    return "  " + left + wrapped(text, left_column, left.size() + 2);
}

bool is_of_every_day(const std::string& group) { return std::ranges::count(groups_of_every_day, group) > 0; }

/// The names of an option, and its value.
std::string left_of(const CLI::Option& option) {
    const std::string names = CLI::detail::join(spellings_of(option), ", ");
    if (takes_value(option)) return names + " " + option.get_type_name();
    return choices_of(option).empty() ? names : names + "[=NAME]";
}

std::string group_text(const CLI::App& command, const std::string& group, bool all) {
    std::string text;
    for (const CLI::Option* option : options_of(command))
        if (option->get_group() == group)
            text += help_row(left_of(*option), all ? option->get_description() : brief(option->get_description()));
    return text.empty() ? text : "\n" + group + ":\n" + text;
}

std::string arguments_text(const CLI::App& command, bool all) {
    std::string text, more;
    for (const CLI::Option* positional : positionals_of(command))
        text += help_row(key_of(*positional), positional->get_description());
    if (!text.empty()) text = "\nArguments:\n" + text;
    for (const std::string& group : command.get_groups()) {
        if (group.empty()) continue;
        if (all || is_of_every_day(group))
            text += group_text(command, group, all);
        else
            more += (more.empty() ? "" : ", ") + group;
    }
    return more.empty() ? text : text + "\n" + wrapped("More, by --help-all: " + more, 0, 0);
}

std::string usage_of(const CLI::App& command) {
    std::string text = "Usage: claray";
    if (command.get_parent() != nullptr) text += " " + command.get_name();
    text += " [OPTIONS]";
    for (const CLI::Option* positional : positionals_of(command))
        text += positional->get_required() ? " " + key_of(*positional) : " [" + key_of(*positional) + "]";
    return text + (command.get_parent() == nullptr ? " COMMAND\n" : "\n");
}

class HelpFormatter : public CLI::Formatter {
public:
    std::string make_help(const CLI::App* command, std::string, CLI::AppFormatMode mode) const override {
        const bool all = mode == CLI::AppFormatMode::All;
        std::string text = command->get_description() + "\n" + usage_of(*command) + arguments_text(*command, all);
        const auto commands = commands_of(*command);
        if (!commands.empty()) text += "\nCommands:\n";
        for (const CLI::App* one : commands) text += help_row(one->get_name(), one->get_description());
        if (all)
            for (const CLI::App* one : commands)
                text += "\n\n" + one->get_description() + "\n" + usage_of(*one) + arguments_text(*one, true);
        const bool has_footer = command->get_parent() == nullptr ||  // whose footer commands without one have
                                command->get_footer() != command->get_parent()->get_footer();
        return has_footer ? text + "\n" + command->get_footer() + "\n" : text;
    }
};

}  // namespace

void set_help(CLI::App& app) {
    app.set_help_flag("-h,--help", "Print a short help and exit");
    app.set_help_all_flag("--help-all", "Print all options and exit");
    app.formatter(std::make_shared<HelpFormatter>());
}

}  // namespace claray::cli
