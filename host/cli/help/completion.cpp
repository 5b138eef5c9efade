// claray completion: scripts that complete command lines.
#include "host/cli/help/completion.hpp"

#include <cstdio>

#include "claray/scene.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help/option_facts.hpp"
#include "host/cli/options/option_rules.hpp"

namespace claray::cli {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    return CLI::detail::find_and_replace(std::move(text), what, by);
}

/// For shells: in single quotes.
std::string shell_quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

/// A line of text about an option.
std::string line_of(const CLI::Option& option) { return replaced(brief(option.get_description()), "\n", " "); }

/// Built-in scenes, which stand for files; a number or a name follows a colon.
std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const std::string name : builtin_scene_names()) {
        const std::size_t colon = name.find(':');
        names.push_back(colon == std::string::npos ? name : name.substr(0, colon + 1));
    }
    return names;
}

/// What a positional argument may be, beside a file.
std::vector<std::string> words_of(const CLI::Option& positional) {
    return key_of(positional) == "scene" ? scene_names() : choices_of(positional);
}

std::string joined(const std::vector<std::string>& words, const char* between = " ") {
    return CLI::detail::join(words, between);
}

std::vector<std::string> all_spellings(const CLI::App& command) {
    std::vector<std::string> words;
    for (const CLI::Option* option : options_of(command))
        for (const std::string& word : spellings_of(*option)) words.push_back(word);
    return words;
}

/// "'render --aov') words='depth normal' ;;" for each option that takes a value.
std::string bash_values(const CLI::App& command) {
    std::string text;
    for (const CLI::Option* option : options_of(command)) {
        const std::vector<std::string> choices = choices_of(*option);
        if (!takes_value(*option) && choices.empty()) continue;
        std::string pattern;
        for (const std::string& word : spellings_of(*option))
            pattern += (pattern.empty() ? "" : "|") + shell_quoted(command.get_name() + " " + word);
        const std::string kind = !choices.empty()     ? is_list(*option) ? "list" : "words"
                                 : is_number(*option) ? "none"
                                                      : "file";
        text += "        " + pattern + ") kind=" + kind;
        if (!choices.empty()) text += " words=" + shell_quoted(joined(choices));
        if (!takes_value(*option)) text += " optional=1";
        text += " ;;\n";
    }
    return text;
}

std::string bash_commands(const CLI::App& app) {
    std::string text;
    for (const CLI::App* command : commands_of(app)) {
        std::vector<std::string> words;
        for (const CLI::Option* positional : positionals_of(*command))
            for (const std::string& word : words_of(*positional)) words.push_back(word);
        text += "        " + command->get_name() + ") options=" + shell_quoted(joined(all_spellings(*command)));
        text += " words=" + shell_quoted(joined(words)) + " ;;\n";
    }
    return text;
}

std::string zsh_escaped(std::string text) {
    for (const char* mark : {"\\", "[", "]", ":"}) text = replaced(text, mark, std::string("\\") + mark);
    return text;
}

/// ":NAME:(a b c)": what follows an option, for _arguments.
std::string zsh_value(const CLI::Option& option, const std::vector<std::string>& words) {
    const std::string type = zsh_escaped(option.get_positional() ? key_of(option) : option.get_type_name());
    if (is_list(option) && !words.empty()) return ":" + type + ":_values -s , name " + joined(words);
    if (option.get_positional() && !words.empty() && names_file(option))
        return ":" + type + ": _alternative \"words:name:(" + zsh_escaped(joined(words)) + ")\" \"files:file:_files\"";
    if (!words.empty()) return ":" + type + ":(" + zsh_escaped(joined(words)) + ")";
    return ":" + type + ":" + (is_number(option) ? "" : "_files");
}

std::string zsh_arguments(const CLI::App& command) {
    std::string text;
    for (const CLI::Option* option : options_of(command))
        for (const std::string& word : spellings_of(*option)) {
            const std::vector<std::string> choices = choices_of(*option);
            std::string spec = (is_repeatable(*option) ? "*" : "") + word;
            if (!takes_value(*option) && !choices.empty()) spec += "=-";
            spec += "[" + zsh_escaped(line_of(*option)) + "]";
            if (takes_value(*option)) spec += zsh_value(*option, choices);
            if (!takes_value(*option) && !choices.empty()) spec += ":" + zsh_value(*option, choices);
            text += " \\\n                " + shell_quoted(spec);
        }
    int place = 1;
    for (const CLI::Option* positional : positionals_of(command))
        text += " \\\n                " +
                shell_quoted(std::to_string(place++) + zsh_value(*positional, words_of(*positional)));
    return text;
}

std::string fish_option(const std::string& command, const CLI::Option& option) {
    std::string text = "complete -c claray -n '__fish_seen_subcommand_from " + command + "'";
    for (const std::string& word : spellings_of(option))
        text += word.starts_with("--") ? " -l " + word.substr(2) : " -s " + word.substr(1);
    const std::vector<std::string> choices = choices_of(option);
    if (takes_value(option)) text += choices.empty() && !is_number(option) ? " -r -F" : " -x";
    if (takes_value(option) && is_list(option) && !choices.empty())
        text += " -a '(__fish_append , " + joined(choices) + ")'";
    else if (!choices.empty())
        text += " -a " + shell_quoted(joined(choices));
    return text + " -d " + shell_quoted(line_of(option)) + "\n";
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
    std::vector<std::string> names;
    std::string values;
    for (const CLI::App* command : commands_of(app)) {
        names.push_back(command->get_name());
        values += bash_values(*command);
    }
    return "# Completion of claray for bash, by: claray completion bash\n"
           "_claray() {\n"
           "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]}\n"
           "    local kind= words= options= optional= equals= head=\n"
           "    COMPREPLY=()\n"
           "    if (( COMP_CWORD == 1 )); then\n"
           "        COMPREPLY=($(compgen -W " +
           shell_quoted(joined(names) + " " + joined(all_spellings(app))) +
           " -- \"$current\"))\n"
           "        return\n"
           "    fi\n"
           "    if [[ $current == = ]]; then equals=1 current=  # bash breaks words at it\n"
           "    elif [[ $previous == = ]]; then equals=1 previous=${COMP_WORDS[COMP_CWORD-2]}\n"
           "    fi\n"
           "    case \"$command $previous\" in\n" +
           values +
           "    esac\n"
           "    [[ $optional && ! $equals ]] && kind=\n"
           "    case $kind in\n"
           "        words) COMPREPLY=($(compgen -W \"$words\" -- \"$current\")); return ;;\n"
           "        list) head=${current%\"${current##*,}\"}\n"
           "              COMPREPLY=($(compgen -P \"$head\" -W \"$words\" -- \"${current##*,}\")); return ;;\n"
           "        none) return ;;\n"
           "        file) compopt -o default 2> /dev/null; return ;;\n"
           "    esac\n"
           "    words=\n"
           "    case $command in\n" +
           bash_commands(app) +
           "    esac\n"
           "    if [[ $current == -* ]]; then\n"
           "        COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
           "    else\n"
           "        compopt -o default 2> /dev/null\n"
           "        COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
           "        compgen -f -- \"$current\" > /dev/null && COMPREPLY+=($(compgen -f -- \"$current\")) && compopt -o "
           "filenames 2> /dev/null\n"
           "    fi\n"
           "    return 0\n"
           "}\n"
           "complete -F _claray claray\n";
}

std::string zsh_completion(const CLI::App& app) {
    std::string commands, cases;
    for (const CLI::App* command : commands_of(app)) {
        commands += "                " +
                    shell_quoted(command->get_name() + ":" + zsh_escaped(command->get_description())) + "\n";
        cases += "        " + command->get_name() + ")\n            _arguments -s" + zsh_arguments(*command) + " ;;\n";
    }
    return "#compdef claray\n"
           "# Completion of claray for zsh, by: claray completion zsh\n"
           "_claray() {\n"
           "    local curcontext=$curcontext state line\n"
           "    local -a commands\n"
           "    commands=(\n" +
           commands +
           "    )\n"
           "    _arguments -C" +
           zsh_arguments(app) +
           " \\\n"
           "                '1: :->command' '*:: :->arguments'\n"
           "    case $state in\n"
           "        command) _describe -t commands 'command' commands; return ;;\n"
           "    esac\n"
           "    case $line[1] in\n" +
           cases +
           "    esac\n"
           "}\n"
           "if [[ $funcstack[1] == _claray ]]; then _claray \"$@\"; else compdef _claray claray; fi\n";
}

std::string fish_completion(const CLI::App& app) {
    std::string text = "# Completion of claray for fish, by: claray completion fish\n";
    for (const CLI::App* command : commands_of(app)) {
        const std::string name = command->get_name();
        text += "complete -c claray -f -n __fish_use_subcommand -a " + name + " -d " +
                shell_quoted(command->get_description()) + "\n";
        for (const CLI::Option* option : options_of(*command)) text += fish_option(name, *option);
        for (const CLI::Option* positional : positionals_of(*command))
            if (const auto words = words_of(*positional); !words.empty())
                text += "complete -c claray -n '__fish_seen_subcommand_from " + name + "' -a " +
                        shell_quoted(joined(words)) + "\n";
    }
    return text;
}

void add_completion_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("completion", "Print a script that completes command lines in a shell");
    command->footer(
        "Packages install these scripts. To load one now, or from ~/.bashrc, ~/.zshrc or ~/.config/fish/config.fish:\n"
        "  source <(claray completion bash)\n"
        "  source <(claray completion zsh)\n"
        "  claray completion fish | source");
    auto shell = std::make_shared<std::string>();
    command->add_option("shell", *shell, "bash, zsh or fish")->required()->check(name_among({"bash", "zsh", "fish"}));
    command->callback([&app, &action, shell] {
        action = [&app, shell] {
            const auto script = *shell == "bash" ? bash_completion : *shell == "zsh" ? zsh_completion : fish_completion;
            std::fputs(script(app).c_str(), stdout);
        };
    });
}

}  // namespace claray::cli
