// claray view: looks at a scene while it changes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>

#include "host/base/format.hpp"
#include "host/base/percentile.hpp"
#include "host/base/process/environment.hpp"
#include "host/base/process/process.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/job/job.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/options/view_options.hpp"
#include "host/cli/output/brightness.hpp"
#include "host/cli/output/messages.hpp"
#include "host/cli/output/progress.hpp"
#include "host/io/scene_readers.hpp"
#include "host/lights/light_probe.hpp"
#include "host/view/camera_control.hpp"
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
    bool window = false, terminal = false, quiet = false, browser = true;
    std::vector<std::string> render_options;  // for `claray render`, but for what the view changes
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

/// A word of a POSIX shell.
std::string quoted(const std::string& text) {
    const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || std::strchr("-_./:,=+", c) != nullptr; };
    if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
    return word + "'";
}

/// The options of the command line that `claray render` has, too, but for those that a view changes.
std::vector<std::string> options_for_render(CLI::App& command) {
    static const std::set<std::string> changed = {
        "--camera",         "--look-at", "--up",  "--fov",      "--ortho",  "--projection", "--aperture",
        "--focus-distance", "--size",    "--spp", "--exposure", "--output", "--at"};
    const CLI::App& render = *command.get_parent()->get_subcommand("render");
    std::vector<std::string> words;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        if (option->count() == 0 || !name.starts_with("-") || changed.contains(name) ||
            render.get_option_no_throw(name) == nullptr)
            continue;
        words.push_back(name);
        if (option->get_items_expected_max() > 0)
            words.insert(words.end(), option->results().begin(), option->results().end());
    }
    return words;
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

std::string triple(const glm::vec3& v) { return printed("%.9g,%.9g,%.9g", double(v.x), double(v.y), double(v.z)); }

/// Options for the light that claray chose as the first camera sees the scene. Renders by another would choose other.
std::vector<std::string> options_of(const DefaultLight& light, const Camera& camera) {
    if (light.sky) return {"--sky", triple(light.sky->horizon) + "," + triple(light.sky->zenith)};
    if (light.environment) return {"--studio", triple(camera.target - camera.position)};
    if (!light.lamp) return {};
    return {"--light", "point,position=" + triple(light.lamp->position) + ",intensity=" +
                           triple(light.lamp->intensity) + ",attenuation=" + triple(light.lamp->attenuation)};
}

/// Adds options that renders need for the same light.
view::View view_of(const Device& device, LiveOptions& options) {
    view::ViewConfig config = options.config;
    FirstFrame first;
    Scene scene = load_view(options.scene, options.view, config.render.width, config.render.height, &first);
    if (options.view.exposes && first.exposure())
        config.picture.exposure = *first.exposure();
    else if (options.view.exposes)
        config.picture.exposure = exposure_for_lights(scene, float(config.render.width) / float(config.render.height));
    config.animation = animation_of(options, first);
    view::View view(device, std::move(scene), config);
    const std::vector<std::string> light = options_of(first.light.value_or(DefaultLight()), view.camera());
    options.render_options.insert(options.render_options.end(), light.begin(), light.end());
    return view;
}

/// Arguments of claray that render the image of what is seen.
std::vector<std::string> render_of(const view::View& view, const LiveOptions& options) {
    const RenderConfig& render = view.config().render;
    const PictureConfig& picture = view.config().picture;
    std::vector<std::string> words = {"render", options.scene};
    words.insert(words.end(), options.render_options.begin(), options.render_options.end());
    std::istringstream of_view(view::options_of(view.camera()) +
                               printed(" --size %ux%u --spp %u --exposure %g --tone-map %s", render.width,
                                       render.height, render.spp, double(picture.exposure),
                                       picture.tone_map == ToneMap::none ? "none" : "aces") +
                               " --output view.png");
    words.insert(words.end(), std::istream_iterator<std::string>(of_view), {});
    for (const std::string& edit : view.edits()) words.insert(words.end(), {"--set", edit});
    const double time = view.state().time;
    if (options.view.load.time || time > 0) words.insert(words.end(), {"--at", printed("%.9g", time)});
    if (view.state().denoises) words.push_back("--denoise=claray");
    return words;
}

std::string command_line_of(const std::vector<std::string>& arguments) {
    std::string line = "claray";
    for (const std::string& word : arguments) line += " " + quoted(word);
    return line + "\n";
}

std::string job_of(const std::vector<std::string>& arguments) {
    CLI::App app;
    Action none;
    add_render_command(app, none);
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    return job_text(*app.get_subcommand("render"));
}

/// Where there is a display, a browser shows the page.
void open_browser(const std::string& url) {
    if (environment("DISPLAY").empty() && environment("WAYLAND_DISPLAY").empty()) return;
    (void)start_silently({"xdg-open", url});
}

void serve(view::View& view, const Device& device, const LiveOptions& options, const std::function<bool()>& goes_on) {
    LiveOptions shown = options;
    view::WebConfig web{.host = options.host, .port = options.port, .goes_on = goes_on};
    web.ready = [&](const std::string& url) {
        std::printf("view: %s (Ctrl-C ends)\n", url.c_str());
        std::fflush(stdout);
        if (options.browser) open_browser(url);
    };
    web.open = [&](const std::filesystem::path& file) {
        LiveOptions other = options;
        other.scene = file.string(), other.view = {}, other.view.load.live = true, other.render_options.clear();
        other.view.exposes = true;
        view::View opened = view_of(device, other);
        other.scene = file.filename().string();
        shown = other;
        return opened;
    };
    web.command_line = [&](const view::View& seen) { return command_line_of(render_of(seen, shown)); };
    web.job = [&](const view::View& seen) { return job_of(render_of(seen, shown)); };
    view::serve(view, web);
}

void look(LiveOptions options) {
    view::Script script;
    if (!options.script.empty()) script = view::read_script(options.script);
    if (options.window) view::require_window();
    if (options.script.empty()) view::require_live_size(options.config.render.width, options.config.render.height);
    const Device device = open_device(options.device);
    view::View view = view_of(device, options);
    const InterruptGuard guard(Interrupts::commands);
    const auto goes_on = [] { return !InterruptGuard::interrupted(); };
    if (!options.script.empty()) return replay(view, script, options);
    if (options.window) return view::run_in_window(view, goes_on);
    if (options.terminal) return view::run_in_terminal(view, goes_on);
    serve(view, device, options, goes_on);
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
                     "A scene file (" + scene_extensions() + "), or a built-in scene (see claray scenes)")
        ->required();
    add_size_option(*command, render.width, render.height, "WIDTHxHEIGHT in pixels [640x360]");
    command->add_option("--port", options->port, "Port of the web page; 0: any that is free [8080]")
        ->transform(whole_number(0, 65535));
    command->add_option("--host", options->host,
                        "Address of the web page [127.0.0.1]; 0.0.0.0 serves it to all computers that reach this one,\n"
                        "with the token that is printed");
    command->add_flag("!--no-browser", options->browser,
                      "Open no browser; without it one opens where there is a display");
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
        options->view.exposes = command->count("--exposure") == 0;
        options->render_options = options_for_render(*command);
        action = [options] { look(*options); };
    });
}

}  // namespace claray::cli
