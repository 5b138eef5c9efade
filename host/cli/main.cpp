// claray: the program. Exit codes: 0 done, 1 input or environment, 2 command line, 3 OpenCL (see claray/error.hpp).
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>

#include "claray/error.hpp"
#include "claray/io.hpp"
#include "claray/program.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/usage_error.hpp"

namespace {

/// What is to be reported of a device or a compiler has many lines: they go to a file, and the first line names it.
std::string one_line(const std::string& message) {
    const std::size_t end = message.find('\n');
    if (end == std::string::npos) return message;
    std::error_code no_folder;
    const auto path =
        std::filesystem::temp_directory_path(no_folder) / ("claray-" + std::to_string(::getpid()) + ".log");
    try {
        claray::write_file(path, message + "\n");
        return message.substr(0, end) + "; the log is in " + path.string();
    } catch (const claray::Error&) {
        return message.substr(0, end) + "; the log could not be written to " + path.string();
    }
}

int fail(claray::ErrorKind kind, const std::string& message) {
    std::fprintf(stderr, "claray: error: %s\n", one_line(message).c_str());
    return int(kind);
}

void flush_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        throw claray::Error(claray::ErrorKind::user,
                            std::string("cannot write to standard output: ") + std::strerror(errno));
}

/// Only what had to be compiled is missed: a cache that holds everything may be read-only.
void warn_of_lost_kernels() {
    const std::string error = claray::compile_statistics().cache_error;
    if (error.empty()) return;
    std::fprintf(stderr,
                 "claray: warning: compiled kernels are not kept for the next time: %s; set CLARAY_CACHE_DIR to a "
                 "folder that you may write to\n",
                 error.c_str());
}

int run(int argc, char** argv) {
    CLI::App app{"Ray tracing on any OpenCL device: a mesh goes in, an image comes out.", "claray"};
    app.footer(
        "Examples:\n"
        "  claray devices\n"
        "  claray render spheres -o spheres.png --device cpu --spp 256\n"
        "  claray render scene.obj -o scene.png --camera 3,2,5 --look-at 0,1,0 --fov 50\n"
        "'claray COMMAND --help' tells more. $CLARAY_DEVICE is the device where --device is not given.");
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
        return fail(claray::ErrorKind::usage, claray::cli::usage_error(app, argc, argv, error));
    }
    if (!action) return fail(claray::ErrorKind::usage, "a command is missing; see claray --help");
    action();
    flush_output();
    warn_of_lost_kernels();
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const claray::Error& error) {
        return fail(error.kind(), error.what());
    } catch (const std::bad_alloc&) {
        return fail(claray::ErrorKind::user, "out of memory; use a smaller scene or image");
    } catch (const std::exception& error) {
        return fail(claray::ErrorKind::device, error.what());
    }
}
