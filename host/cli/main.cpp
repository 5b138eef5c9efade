// claray: the program. Exit codes: 0: success; 1: input or environment; 2: invalid command line; 3: OpenCL (see
// claray/error.hpp).
#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "claray/error.hpp"
#include "claray/program.hpp"
#include "claray/program/compiling.hpp"
#include "host/base/did_you_mean.hpp"
#include "host/base/message.hpp"
#include "host/base/process/process.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/help/option_facts.hpp"
#include "host/cli/job/job.hpp"
#include "host/cli/output/messages.hpp"
#include "host/cli/output/progress.hpp"
#include "host/cli/ranks.hpp"
#include "host/compute/programs/compiler_processes.hpp"

namespace claray::cli {
namespace {

/// About the first word that no option and no argument accepts.
std::string unexpected(const CLI::App& command) {
    const std::vector<std::string> words = command.remaining();
    const std::string word = words.empty() ? "?" : words.front();
    if (!word.starts_with('-')) return "'" + word + "' is an unexpected argument";
    const std::string option = word.substr(0, word.find('='));
    std::vector<std::string> known;
    for (const CLI::Option* one : options_of(command))
        for (const std::string& name : spellings_of(*one)) known.push_back(name);
    return "unknown option '" + option + "'" + did_you_mean(option, known);
}

/// "--output: 1 required TEXT missing" -> "--output"
std::string option_of(const CLI::ParseError& error) {
    const std::string text = error.what();
    return text.substr(0, std::min(text.find(": "), text.find(' ')));
}

std::string what_is_wrong(const CLI::App& command, const CLI::ParseError& error) {
    // A misspelt option may be the reason for a missing one.
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

/// One line: what is wrong, where, and what to do. `app` threw `error` when it parsed these arguments.
std::string usage_error(const CLI::App& app, const std::vector<std::string>& arguments, const CLI::ParseError& error) {
    const std::vector<CLI::App*> commands = app.get_subcommands();
    const bool any = !commands.empty();
    if (!any && !arguments.empty() && !arguments[0].starts_with('-')) {
        std::vector<std::string> names;
        for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
        return "unknown command '" + arguments[0] + "'" + did_you_mean(arguments[0], names) + "; see claray --help";
    }
    return what_is_wrong(any ? *commands.front() : app, error) + "; see claray " +
           (any ? commands.front()->get_name() + " " : std::string()) + "--help";
}

/// An unset variable in a script gives an option an empty value.
void refuse_empty_values(const CLI::App& app) {
    for (const CLI::App* command : app.get_subcommands())
        for (const CLI::Option* option : command->get_options())
            for (const std::string& value : option->results())
                if (value.empty() && option->get_expected_max() > 0)
                    throw Error(ErrorKind::usage, option->get_name() + " has an empty value",
                                "give a value, or leave the option out");
}

bool is_quiet(const CLI::App& app) {
    const std::vector<CLI::App*> commands = app.get_subcommands();
    return std::ranges::any_of(commands, [](const CLI::App* command) {
        const CLI::Option* quiet = command->get_option_no_throw("--quiet");
        return quiet != nullptr && quiet->count() > 0;
    });
}

void flush_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        throw Error(ErrorKind::user, std::string("cannot write to standard output: ") + std::strerror(errno));
}

/// A cache that holds all kernels may be read-only: nothing had to be written.
void warn_of_lost_kernels() {
    const std::string error = compile_statistics().cache_error;
    if (error.empty()) return;
    print_warning("compiled kernels cannot be cached: " + error + "; set CLARAY_CACHE_DIR to a writable folder");
}

int run_program(int argc, char** argv) {
    CLI::App app{"Renders scenes by ray tracing on any OpenCL device.", "claray"};
    app.footer(
        "Examples:\n"
        "  claray devices\n"
        "  claray render spheres -o spheres.png --device cpu --spp 256\n"
        "  claray render scene.obj -o scene.png --camera 3,2,5 --look-at 0,1,0 --fov 50\n"
        "'claray COMMAND --help' describes a command, --help-all with all of its options. $CLARAY_DEVICE is the "
        "default of --device.");
    set_help(app);
    app.set_version_flag("--version", "claray " CLARAY_VERSION);
    app.require_subcommand(0, 1);  // without one see below: CLI11 would not name an unknown command
    Action action;
#define CLARAY_ADD(name) add_##name##_command(app, action);
    CLARAY_COMMANDS(CLARAY_ADD)
#undef CLARAY_ADD
    std::vector<std::string> arguments(argv + 1, argv + argc);
    if (argc > 1 && arguments[0] == "render") arguments = without_job(arguments);
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
        refuse_empty_values(app);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return report_error(ErrorKind::usage, one_line(usage_error(app, arguments, error)));
    }
    if (!action) return report_error(ErrorKind::usage, "the command is missing; see claray --help");
    if (!is_quiet(app) && !is_other_rank()) on_compiling(compiling_lines());
    action();
    flush_output();
    warn_of_lost_kernels();
    return 0;
}

int run_and_report(int argc, char** argv) {
    try {
        start_ranks(argc, argv);
        set_compiler_program(this_program());
        return run_program(argc, argv);
    } catch (const Error& error) {
        return report_error(error.kind(), error.what());
    } catch (const std::bad_alloc&) {
        return report_error(ErrorKind::user, "out of memory; use a smaller scene or image");
    } catch (const std::exception& error) {
        return report_error(ErrorKind::device, error.what());
    }
}

/// Compilers in drivers recurse deeply, and `ulimit -s` bounds the stack of the first thread only: if that is less than
/// the usual 8 MiB, the program runs in a second thread with 8 MiB.
int run_with_enough_stack(int argc, char** argv) {
    constexpr std::size_t enough = std::size_t(8) << 20;
    struct rlimit limit = {};
    if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= enough)
        return end_ranks(run_and_report(argc, argv));
    struct Call {
        int argc;
        char** argv;
        int exit_code;
    } call = {argc, argv, 0};
    const auto start = [](void* data) -> void* {
        Call& its = *static_cast<Call*>(data);
        its.exit_code = end_ranks(run_and_report(its.argc, its.argv));
        return nullptr;
    };
    pthread_attr_t attributes;
    pthread_t thread;
    const bool started = ::pthread_attr_init(&attributes) == 0 &&
                         ::pthread_attr_setstacksize(&attributes, enough) == 0 &&
                         ::pthread_create(&thread, &attributes, start, &call) == 0;
    if (!started) return end_ranks(run_and_report(argc, argv));
    ::pthread_join(thread, nullptr);
    return call.exit_code;
}

}  // namespace
}  // namespace claray::cli

int main(int argc, char** argv) {
    const int exit_code = claray::cli::run_with_enough_stack(argc, argv);
    claray::cli::end_by_interrupt();
    return exit_code;
}
