// claray: the program. Exit codes: 0: success; 1: input or environment; 2: invalid command line; 3: OpenCL (see
// claray/error.hpp).
#include <pthread.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include "claray/error.hpp"
#include "claray/program.hpp"
#include "host/base/message.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/usage_error.hpp"
#include "host/cli/output/messages.hpp"

namespace {

void flush_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        throw claray::Error(claray::ErrorKind::user,
                            std::string("cannot write to standard output: ") + std::strerror(errno));
}

/// Only what had to be compiled is missed: a cache that holds everything may be read-only.
void warn_of_lost_kernels() {
    const std::string error = claray::compile_statistics().cache_error;
    if (error.empty()) return;
    claray::cli::print_warning("compiled kernels cannot be cached: " + error +
                               "; set CLARAY_CACHE_DIR to a writable folder");
}

int run_program(int argc, char** argv) {
    CLI::App app{"Renders scenes by ray tracing on any OpenCL device.", "claray"};
    app.footer(
        "Examples:\n"
        "  claray devices\n"
        "  claray render spheres -o spheres.png --device cpu --spp 256\n"
        "  claray render scene.obj -o scene.png --camera 3,2,5 --look-at 0,1,0 --fov 50\n"
        "'claray COMMAND --help' describes a command. $CLARAY_DEVICE is the default of --device.");
    app.set_version_flag("--version", "claray " CLARAY_VERSION);
    app.require_subcommand(0, 1);  // without one see below: CLI11 would not name an unknown command
    claray::cli::Action action;
    claray::cli::add_devices_command(app, action);
    claray::cli::add_scenes_command(app, action);
    claray::cli::add_render_command(app, action);
    claray::cli::add_explain_command(app, action);
    claray::cli::add_compile_command(app, action);
    claray::cli::add_bake_command(app, action);
    claray::cli::add_build_command(app, action);
    claray::cli::add_bench_command(app, action);
    claray::cli::add_tune_command(app, action);
    claray::cli::add_verify_command(app, action);
    claray::cli::add_accuracy_command(app, action);
    try {
        app.parse(argc, argv);
        claray::cli::refuse_empty_values(app);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return claray::cli::print_error(claray::ErrorKind::usage,
                                        claray::one_line(claray::cli::usage_error(app, argc, argv, error)));
    }
    if (!action) return claray::cli::print_error(claray::ErrorKind::usage, "the command is missing; see claray --help");
    action();
    flush_output();
    warn_of_lost_kernels();
    return 0;
}

int run_and_report(int argc, char** argv) {
    try {
        return run_program(argc, argv);
    } catch (const claray::Error& error) {
        return claray::cli::print_error(error.kind(), error.what());
    } catch (const std::bad_alloc&) {
        return claray::cli::print_error(claray::ErrorKind::user, "out of memory; use a smaller scene or image");
    } catch (const std::exception& error) {
        return claray::cli::print_error(claray::ErrorKind::device, error.what());
    }
}

/// Compilers of drivers go deep, and `ulimit -s` bounds the stack of the first thread only: on less than the usual 8
/// MiB the program runs in a second one that has them.
int run_with_enough_stack(int argc, char** argv) {
    constexpr std::size_t enough = std::size_t(8) << 20;
    struct rlimit limit = {};
    if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= enough) return run_and_report(argc, argv);
    struct Call {
        int argc;
        char** argv;
        int exit_code;
    } call = {argc, argv, 0};
    const auto start = [](void* data) -> void* {
        Call& its = *static_cast<Call*>(data);
        its.exit_code = run_and_report(its.argc, its.argv);
        return nullptr;
    };
    pthread_attr_t attributes;
    pthread_t thread;
    const bool started = ::pthread_attr_init(&attributes) == 0 &&
                         ::pthread_attr_setstacksize(&attributes, enough) == 0 &&
                         ::pthread_create(&thread, &attributes, start, &call) == 0;
    if (!started) return run_and_report(argc, argv);
    ::pthread_join(thread, nullptr);
    return call.exit_code;
}

}  // namespace

int main(int argc, char** argv) { return run_with_enough_stack(argc, argv); }
