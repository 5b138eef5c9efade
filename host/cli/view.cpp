// claray view: looks at a scene while it changes.
#include <cmath>
#include <cstdio>
#include <memory>

#include "host/base/format.hpp"
#include "host/base/percentile.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/options/view_options.hpp"
#include "host/cli/output/brightness.hpp"
#include "host/cli/output/messages.hpp"
#include "host/cli/output/progress.hpp"
#include "host/lights/light_probe.hpp"
#include "host/view/input.hpp"
#include "host/view/script.hpp"
#include "host/view/terminal.hpp"
#include "host/view/web/web.hpp"
#include "host/view/window/window.hpp"

namespace claray::cli {
namespace {

struct LiveOptions {
    std::string scene, device, host = "127.0.0.1";
    ViewOptions view;
    view::ViewConfig config;
    std::filesystem::path script, output;
    int port = 8080;
    bool window = false, terminal = false, quiet = false;
    bool chooses_exposure = false;
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

/// Median and 99th percentile of times, in milliseconds; nothing where there are none.
void print_times(const std::vector<double>& seconds, const char* of) {
    if (seconds.empty()) return;
    std::printf("%s: %zu, median %.2f ms, 99th percentile %.2f ms\n", of, seconds.size(),
                1e3 * percentile(seconds, 0.5), 1e3 * percentile(seconds, 0.99));
}

void replay(view::View& view, const view::Script& script, const LiveOptions& options) {
    if (!options.output.empty()) std::filesystem::create_directories(options.output);
    const auto tell = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
    const view::ScriptReport report = view::run_script(view, script, options.output, tell);
    if (options.quiet) return;
    print_times(report.frame_seconds, "frames");
    print_times(report.finish_seconds, "complete images by finish");
    print_times(report.answer_seconds, "answers of frames to commands");
}

/// The exposure that shows grey surfaces in the light of the scene's own lights, which may be in lux and candela.
float exposure_for_lights(const Scene& scene, float aspect) {
    if (scene.lights.empty() || triangle_count(scene) == 0) return 0;
    const double grey = probe_light(scene, camera_of(scene, aspect), aspect).brightness;
    if (grey <= white_luminance) return 0;
    const auto stops = float(std::round(-10 * std::log2(2 * grey)) / 10);
    print_warning(
        printed("the surfaces would be mostly white: their exposure is %+.1f stops; choose another with "
                "--exposure, 0 for none",
                double(stops)));
    return stops;
}

void look(const LiveOptions& options) {
    view::Script script;
    if (!options.script.empty()) script = view::read_script(options.script);
    if (options.window) view::require_window();
    if (options.script.empty()) view::require_live_size(options.config.render.width, options.config.render.height);
    const Device device = open_device(options.device);
    view::ViewConfig config = options.config;
    FirstFrame first;
    Scene scene = load_view(options.scene, options.view, config.render.width, config.render.height, &first);
    if (options.chooses_exposure)
        config.picture.exposure = exposure_for_lights(scene, float(config.render.width) / float(config.render.height));
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
    options->view.load.live = true;
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
    command
        ->add_option("--exposure", options->config.picture.exposure,
                     "Brighten by this many stops [0; darker if the scene's lights make surfaces white]")
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
        options->chooses_exposure = command->count("--exposure") == 0;
        action = [options] { look(*options); };
    });
}

}  // namespace claray::cli
