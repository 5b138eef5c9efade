#include "host/cli/options/render_targets.hpp"

#include <algorithm>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/base/format.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/progress.hpp"
#include "host/cli/output/render_outputs.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

constexpr unsigned most_spp = 1u << 24;

/// In place of an error of 0, which cannot be reached: the message then names the closest possible error.
constexpr const char* least_error = "1e-30";

CLI::Validator least_error_for_none() {
    return {[](std::string& text) {
                if (parse_number<double>(text) == 0.0) text = least_error;
                return std::string();
            },
            ""};
}

void check_frames(const CLI::App& command, RenderOptions& o) {
    if (o.turntable == 0) refuse_without(command, "--frame-rate", "--frames");
    refuse_without(command, "--orbit", "--fps");
    refuse_both(command, "--fps", {"--frame-rate"},
                "--fps is for rendering in real time, --frame-rate for an animation");
    if (is_y4m(o) && o.turntable == 0 && (command.count("--frames") == 0 || o.fps > 0))
        throw Error(ErrorKind::usage,
                    "--output: '" + o.output.string() + "' is a video, which needs the frames of an animation",
                    "add --frames FIRST..LAST or --turntable N, or write an image, as in .png");
    if (o.turntable > 0) {
        o.animation = {0, o.turntable - 1};
        refuse_both(command, "--turntable", {"--frames", "--fps"}, "both tell the frames");
        refuse_both(command, "--turntable", {"--checkpoint", "--resume", "--trace"}, "it renders several images");
        if (is_stream(o))
            refuse_both(command, "--aov", {"--turntable"}, "one stream has no place for them: write files");
    }
    if (command.count("--frames") == 0) return;
    if (o.fps > 0) {
        const auto frames = parse_number<unsigned>(o.frames_text);
        if (!frames || *frames == 0 || *frames > 1'000'000)
            throw Error(ErrorKind::usage, "--frames: '" + o.frames_text + "' is not a whole number in 1..1000000",
                        "with --fps it is the number of frames to render");
        o.frames = *frames;
        return;
    }
    o.animation = parse_frames(o.frames_text);
    if (is_stream(o)) refuse_both(command, "--aov", {"--frames"}, "one stream has no place for them: write files");
    refuse_both(command, "--frames", {"--at"}, "the frames define the times");
    refuse_both(command, "--frames", {"--checkpoint", "--resume", "--trace"}, "--frames renders several images");
}

/// Standard output has the picture, and nothing else.
void check_standard_output(const CLI::App& command, const RenderOptions& o) {
    if (o.output != "-") return;
    for (const char* option : {"--json", "--stats", "--fps"})
        if (command.count(option) > 0)
            throw Error(ErrorKind::usage, std::string(option) + ": standard output has the picture",
                        "write the picture to a file");
    for (const std::string& aov : o.aovs)
        if (!is_layer(o, aov))
            throw Error(ErrorKind::usage, "--aov " + aov + ": standard output has no place for it",
                        format_of(o) == ImageFormat::exr ? "write files" : "write files, or add --format exr");
    if (!o.config.light_groups.empty() && format_of(o) != ImageFormat::exr)
        throw Error(ErrorKind::usage, "--light-group: standard output has no place for it",
                    "write files, or add --format exr");
}

}  // namespace

void add_target_options(CLI::App& command, RenderOptions& o) {
    OptionGroup group(command, "Quality");
    command
        .add_option("--error", o.config.error, "Render until the RMSE over the mean is at most this: for example 0.01")
        ->check(positive_number())
        ->transform(least_error_for_none());
    group.next("Sampling");
    command.add_flag("--adaptive", o.config.adaptive,
                     "Take more samples where the error is large; --spp is then the mean over all pixels");
    group.next("Quality");
    command.add_option("--time", o.config.seconds, "Render as many samples as fit into this time: 500ms, 2s, 1m")
        ->transform(duration())
        ->type_name("TIME");
    group.next("Real time");
    command
        .add_option("--fps", o.fps,
                    "Render frames at this rate with as many samples as fit, and print whether the rate was met")
        ->check(positive_number());
    group.next("Animation");
    command
        .add_option(
            "--frames", o.frames_text,
            "FIRST..LAST: write an image per frame of an animation, as OUTPUT.0000.png or by %04d in OUTPUT, or "
            "all to one video, if OUTPUT is a .y4m or - (standard output, for ffmpeg -i -); "
            "with --fps: number of frames, 300 without it")
        ->type_name("RANGE");
    command
        .add_option("--turntable", o.turntable,
                    "Write N frames, as --frames does, in which the camera turns once round its target")
        ->transform(whole_number(1, 1'000'000))
        ->type_name("N");
    group.next("Real time");
    command.add_option("--orbit", o.orbit, "Degrees by which the camera turns round its target, with --fps [0]")
        ->check(finite_number());
    group.next("Animation");
    command
        .add_option("--frame-rate", o.frame_rate,
                    "Frames per second of the animation, with --frames or --turntable [24]")
        ->check(positive_number());
}

void check_targets(const CLI::App& command, RenderOptions& o) {
    if (command.count("--fps") == 0 && command.count("--output") == 0) throw CLI::RequiredError("--output");
    check_frames(command, o);
    check_standard_output(command, o);
    refuse_both(command, "--fps",
                {"--spp", "--error", "--time", "--noise", "--checkpoint", "--resume", "--aov", "--adaptive"},
                "the frame time decides the number of samples");
    refuse_both(command, "--fps", {"--stats", "--trace"}, "--fps renders several images");
    if (o.fps > 0) o.config.spp = most_spp;
    refuse_both(command, "--error", {"--spp", "--noise"}, "the error decides the number of samples");
    const bool until_target = o.config.error > 0 || o.config.seconds > 0;
    if (until_target && command.count("--spp") == 0) o.config.spp = most_spp;
    o.config.lobes = std::find(o.aovs.begin(), o.aovs.end(), "lobes") != o.aovs.end();
    o.picks_settings = until_target && command.count("--spp") == 0;
    o.picks_builder = command.count("--builder") == 0;
}

void print_picks(const std::vector<std::string>& picks) {
    for (const std::string& pick : picks) std::printf("%s\n", pick.c_str());
}

MeasuringProgress measuring_progress(bool quiet) {
    return [quiet](const std::string& what) {
        if (!quiet) std::fprintf(stderr, "measuring for the planner: %s\n", what.c_str());
        return !InterruptGuard::interrupted();
    };
}

void run_frames(const Device& device, const Scene& scene, const RenderOptions& options) {
    std::optional<InterruptGuard> guard;
    const FramesReport report = render_frames(
        device, scene, options.config,
        {.fps = options.fps, .frames = options.frames, .orbit = options.orbit, .picks_builder = options.picks_builder},
        [&](unsigned) {
            if (!guard) guard.emplace();
            return !InterruptGuard::interrupted();
        },
        measuring_progress(options.quiet));
    if (!options.output.empty()) {
        RenderOptions exposed = options;
        choose_exposure(report.image, nullptr, exposed);
        write_picture(report.image, exposed);
    }
    const double budget = 1e3 / options.fps, p50 = 1e3 * report.median, p99 = 1e3 * report.percentile;
    const double slowest = 1e3 * *std::max_element(report.seconds.begin(), report.seconds.end());
    if (options.json) {
        const nlohmann::ordered_json json = {
            {"scene", options.scene},
            {"device", device.info().name},
            {"fps", options.fps},
            {"frames", report.seconds.size()},
            {"spp", report.spp},
            {"max_depth", report.max_depth},
            {"size", {report.width, report.height}},
            {"approximate", to_string(report.approximate)},
            {"error", report.error},
            {"milliseconds", {{"promised", budget}, {"median", p50}, {"percentile_99", p99}, {"slowest", slowest}}},
            {"picks", report.picks}};
        print_json(json);
    } else {
        if (!options.quiet) print_picks(report.picks);
        std::printf(
            "%s: %zu of %u frames of %ux%u, %u samples per pixel: median %.2f ms, 99th percentile %.2f ms, slowest "
            "%.2f ms (target: %.2f)\n",
            p99 > budget                             ? "missed"
            : report.seconds.size() < options.frames ? "stopped"
                                                     : "reached",
            report.seconds.size(), options.frames, options.config.width, options.config.height, report.spp, p50, p99,
            slowest, budget);
    }
    if (p99 <= budget) return;
    throw Error(ErrorKind::user,
                printed("%.4g frames per second were not reached: the 99th percentile is %.2f ms instead of %.2f",
                        options.fps, p99, budget),
                printed("the closest possible is about --fps %.3g", 1e3 / p99));
}

void refuse_missed_error(const RenderConfig& config, const RenderProgress& reached) {
    if (!(config.error > 0) || (reached.error_bound > 0 && reached.error_bound <= config.error)) return;
    std::string text;
    if (reached.error_bound > 0) {
        const double ratio = reached.error_bound / config.error, needed = reached.error_spp * ratio * ratio;
        text = printed("the error is up to %.3g instead of %g, which needs about %.3g samples per pixel and %.3g s",
                       reached.error_bound, config.error, needed, reached.seconds * needed / reached.spp);
    } else {
        text = printed("the error of %g was not reached: %u samples per pixel are too few to estimate the error",
                       config.error, reached.spp);
    }
    throw Error(ErrorKind::user, text, "the image was written nevertheless");
}

}  // namespace claray::cli
