// claray man: the help of all commands as a page for man(1), in the macros of man(7).
#include <cstdio>
#include <sstream>

#include "host/cli/commands.hpp"
#include "host/cli/help/option_facts.hpp"

namespace claray::cli {
namespace {

/// Text that roff shows as it is: no line begins with a control character.
std::string roff(const std::string& text) {
    std::string out;
    bool begins = true;
    for (const char c : text) {
        if (begins && (c == '.' || c == '\'')) out += "\\&";
        begins = c == '\n';
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
    }
    return out;
}

/// Each line of a description is one of the page.
std::string paragraph(const std::string& text) {
    std::string out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) out += (out.empty() ? "" : ".br\n") + roff(line) + "\n";
    return out;
}

std::string entry(const std::string& bold, const std::string& italic, const std::string& text) {
    return ".TP\n\\fB" + roff(bold) + "\\fR" + (italic.empty() ? "" : " \\fI" + roff(italic) + "\\fR") + "\n" +
           paragraph(text);
}

std::string entry(const CLI::Option& option) {
    return entry(CLI::detail::join(spellings_of(option), ", "), takes_value(option) ? option.get_type_name() : "",
                 option.get_description());
}

bool is_help(const CLI::App& command, const CLI::Option& option) {
    return &option == command.get_help_ptr() || &option == command.get_help_all_ptr();
}

std::string options_text(const CLI::App& command) {
    std::string text;
    for (const CLI::Option* positional : positionals_of(command))
        text += entry(key_of(*positional), "", positional->get_description());
    const bool is_command = command.get_parent() != nullptr;
    for (const std::string& group : command.get_groups()) {
        std::string entries;
        for (const CLI::Option* option : options_of(command))
            if (option->get_group() == group && !group.empty() && !(is_command && is_help(command, *option)))
                entries += entry(*option);
        if (!entries.empty()) text += ".PP\n\\fI" + roff(group) + "\\fR\n" + entries;
    }
    return text;
}

/// Footers have their lines and columns.
std::string as_it_is(const std::string& text) { return ".nf\n" + roff(text) + "\n.fi\n"; }

std::string man_page(const CLI::App& app) {
    std::string text = ".TH CLARAY 1 \"\" \"claray " CLARAY_VERSION
                       "\" \"User Commands\"\n"
                       ".SH NAME\nclaray \\- " +
                       roff(app.get_description()) +
                       "\n"
                       ".SH SYNOPSIS\n\\fBclaray\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n"
                       ".SH DESCRIPTION\n" +
                       as_it_is(app.get_footer()) + ".SH OPTIONS\n" + options_text(app);
    text += ".SH COMMANDS\n";
    for (const CLI::App* command : commands_of(app)) {
        text += ".SS claray " + roff(command->get_name()) + "\n" + paragraph(command->get_description() + ".") +
                options_text(*command);
        if (command->get_footer() != app.get_footer()) text += ".PP\n" + as_it_is(command->get_footer());
    }
    return text;
}

}  // namespace

void add_man_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("man", "Print the manual of all commands, for man");
    command->footer("Packages install it. To read it now: claray man | man -l -");
    command->callback([&app, &action] { action = [&app] { std::fputs(man_page(app).c_str(), stdout); }; });
}

}  // namespace claray::cli
