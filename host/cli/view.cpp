// claray view: looks at a scene while it changes.
#include <cstdio>
#include <memory>

#include "host/base/format.hpp"
#include "host/base/percentile.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/options/view_options.hpp"
#include "host/cli/output/progress.hpp"
#include "host/view/input.hpp"
#include "host/view/script.hpp"
#include "host/view/terminal.hpp"
#include "host/view/web.hpp"
#include "host/view/window.hpp"

namespace claray::cli {
namespace {

struct LiveOptions {
    std::string scene, device, host = "127.0.0.1";
    ViewOptions view;
    view::ViewConfig config;
    std::filesystem::path script, output;
    int port = 8080;
    bool window = false, terminal = false, quiet = false;
};

constexpr double script_step = 1. / 60;  // seconds of an animation per frame

/// The light and the camera of its first scene are those of all.
view::Animation animation_of(const LiveOptions& options, FirstFrame first) {
    const std::optional<double> seconds = animation_seconds(options.scene, options.view.load);
    if (!seconds) return {};
    const auto scene_at = [options, first](double time) mutable {
        ViewOptions then = options.view;
        then.load.time = time, then.load.images = false;
        return load_view(options.scene, then, options.config.render.width, options.config.render.height, &first);
    };
    return {scene_at, *seconds, options.view.load.time.value_or(0), options.script.empty() ? 0 : script_step};
}

/// Median and 99th percentile of times, in milliseconds.
std::string times_of(const std::vector<double>& seconds) {
    if (seconds.empty()) return "none";
    return printed("median %.2f ms, 99th percentile %.2f ms", 1e3 * percentile(seconds, 0.5),
                   1e3 * percentile(seconds, 0.99));
}

void replay(view::View& view, const view::Script& script, const LiveOptions& options) {
    if (!options.output.empty()) std::filesystem::create_directories(options.output);
    const auto tell = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
    const view::ScriptReport report = view::run_script(view, script, options.output, tell);
    if (options.quiet) return;
    std::printf("%u frames: %s\nanswers to commands: %s\n", report.frames, times_of(report.seconds).c_str(),
                times_of(report.answer_seconds).c_str());
}

void look(const LiveOptions& options) {
    view::Script script;
    if (!options.script.empty()) script = view::read_script(options.script);
    if (options.window) view::require_window();
    const Device device = open_device(options.device);
    view::ViewConfig config = options.config;
    FirstFrame first;
    Scene scene = load_view(options.scene, options.view, config.render.width, config.render.height, &first);
    config.animation = animation_of(options, first);
    view::View view(device, std::move(scene), config);
    const InterruptGuard guard(Interrupts::commands);
    const auto goes_on = [] { return !InterruptGuard::interrupted(); };
    if (!options.script.empty()) return replay(view, script, options);
    if (options.window) return view::run_in_window(view, goes_on);
    if (options.terminal) return view::run_in_terminal(view, goes_on);
    view::serve(view,
                {.host = options.host, .port = options.port, .goes_on = goes_on, .ready = [](const std::string& url) {
                     std::printf("view: %s (Ctrl-C ends)\n", url.c_str());
                     std::fflush(stdout);
                 }});
}

std::string list_of_commands() {
    std::string text = std::string("Keys: ") + view::key_help + "\nMouse: " + view::mouse_help +
                       "\nCommands of scripts and of the web page:\n";
    for (const view::CommandRow& row : view::view_commands())
        text += printed("  %s %s: %s\n", row.name, row.arguments, row.help);
    return text;
}

}  // namespace

void add_view_command(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("view", "Look at a scene live: as a web page, in a window, in the terminal, or by a script");
    command->footer(list_of_commands() +
                    "Examples:\n"
                    "  claray view cornell\n"
                    "  claray view walk.glb --window\n"
                    "  claray view walk.glb --terminal\n"
                    "  claray view sponza.obj --script tour.txt -o frames");
    command->option_defaults()->take_last();
    auto options = std::make_shared<LiveOptions>();
    RenderConfig& render = options->config.render;
    render.width = 640, render.height = 360, render.spp = 256;
    command
        ->add_option("scene", options->scene,
                     "A scene file (.obj, .ply, .stl, .gltf, .glb), or a built-in scene (see claray scenes)")
        ->required();
    add_size_option(*command, render.width, render.height, "WIDTHxHEIGHT in pixels [640x360]");
    command->add_option("--port", options->port, "Port of the web page; 0: any that is free [8080]")
        ->transform(whole_number(0, 65535));
    command->add_option("--host", options->host,
                        "Address of the web page [127.0.0.1]; 0.0.0.0 serves it to all computers that reach this one");
    command->add_flag("--window", options->window, "Show the view in a window");
    command->add_flag("--terminal", options->terminal, "Show the view in the terminal");
    command->add_option("--script", options->script, "Replay the commands of FILE, one per line, and end");
    command->add_option("-o,--output", options->output, "Folder for the frames of --script");
    add_view_options(*command, options->view);
    command->add_option("--spp", render.spp, "Samples per pixel at which a still view stops [256]")
        ->transform(whole_number(1, 1 << 24));
    add_approximate_option(*command, render.approximate);
    add_shading_options(*command, render.approximate);
    add_light_grid_options(*command, render.light_grid);
    command->add_option("--max-depth", render.max_depth, "Surfaces per path, at most [128]")
        ->transform(whole_number(1, 1024));
    command->add_option("--exposure", options->config.picture.exposure, "Brighten by this many stops [0]")
        ->check(finite_number());
    command
        ->add_option("--answer", options->config.answer_seconds,
                     "A change that takes longer than this many seconds to show is shown as a smaller image first;\n"
                     "0: never [0.05; 0 with --script]")
        ->check(number_from_0());
    command->add_option("--device", options->device, "cpu, gpu, an index or part of a name (see claray devices)");
    add_bvh_options(*command, render.bvh);
    command->add_flag("-q,--quiet", options->quiet, "Print no times");
    command->callback([&action, command, options] {
        if (command->count("--script") != 0 && command->count("--answer") == 0) options->config.answer_seconds = 0;
        refuse_without(*command, "--output", "--script");
        refuse_both(*command, "--script", {"--window", "--terminal", "--port", "--host"}, "a script needs no display");
        refuse_both(*command, "--window", {"--terminal", "--port", "--host"}, "there is one display");
        refuse_both(*command, "--terminal", {"--port", "--host"}, "there is one display");
        action = [options] { look(*options); };
    });
}

}  // namespace claray::cli
