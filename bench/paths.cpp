// The kernel of whole paths against the stages, by the number of paths that are traced at once:
//   bench_paths [--device D] [--scenes NAME...] [--paths N...] [--side PIXELS] [--spp N] [--rounds N] [--csv FILE]
// Nanoseconds a path, from the start of a render's first command to the end of its last one.
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv;
    std::vector<std::string> scenes = {"crate", "spheres", "hills", "hair:50000", "effect:sky", "effect:many-lights"};
    std::vector<unsigned> paths = {65536, 131072, 262144, 524288, 1048576, 2097152};
    unsigned side = 512, spp = 16;
    int rounds = 5;
};

Options parse(int argc, char** argv) {
    Options options;
    CLI::App app("The kernel of whole paths against the stages");
    app.add_option("--device", options.device);
    app.add_option("--scenes", options.scenes);
    app.add_option("--paths", options.paths, "in flight");
    app.add_option("--side", options.side, "pixels a side [512]");
    app.add_option("--spp", options.spp);
    app.add_option("--rounds", options.rounds);
    app.add_option("--csv", options.csv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error));
    }
    return options;
}

void set_paths(const Device& device, unsigned paths, unsigned most_effects) {
    device.set_tuning("render/wavefront", "PATHS", paths);
    device.set_tuning("render/wavefront", "FIRST_PATHS", paths);
    device.set_tuning("render/trace_paths", "MOST_EFFECTS", most_effects);
    device.set_tuning("render/trace_paths", "MOST_BOUNCES_PERMILLE", 1'000'000);
    device.set_tuning("render/trace_paths", "MOST_PATHS_PER_UNIT", paths);
    device.set_tuning("render/trace_paths", "PATIENCE_MILLISECONDS", 0);
}

void render_anew(Renderer& renderer) {
    renderer.restart(0);
    (void)renderer.render();
}

/// Spans of the renders by stages and by whole paths; the latter is 0 where the scene is none for that.
std::pair<double, double> milliseconds(const Device& device, const Options& options, const Scene& scene,
                                       unsigned paths) {
    RenderConfig config{
        .width = options.side, .height = options.side, .spp = options.spp, .max_depth = 8, .compiler = {}};
    config.bvh.layout = Layout::binary;
    set_paths(device, paths, 99);
    Renderer whole(device, scene, config);
    for (int i = 0; i < 2; ++i) render_anew(whole);  // after which it has decided
    const bool follows = whole.statistics().in_paths.rays > 0;
    set_paths(device, paths, 0);
    Renderer staged(device, scene, config);
    const std::vector<measure::Timing> times =
        measure::measure_rounds(device, options.rounds, {[&] { render_anew(staged); }, [&] { render_anew(whole); }});
    return {times[0].span(), follows ? times[1].span() : 0};
}

}  // namespace

int main(int argc, char** argv) try {
    const Options options = parse(argc, argv);
    const Device device = Device::open(options.device);
    measure::Csv csv(options.csv, device, "scene,paths,stages_ns,whole_ns,whole_over_stages");
    std::printf("%-20s %9s %10s %10s %7s\n", "scene", "paths", "stages ns", "whole ns", "ratio");
    for (const std::string& name : options.scenes) {
        Warnings warnings;
        const Scene scene = load_scene(name, warnings);
        for (const unsigned paths : options.paths) {
            const double per_path = 1e6 / (double(options.side) * options.side * options.spp);
            const auto [stages, whole] = milliseconds(device, options, scene, paths);
            std::printf("%-20s %9u %10.3f %10.3f %7.3f\n", name.c_str(), paths, stages * per_path, whole * per_path,
                        whole / stages);
            std::fflush(stdout);
            csv.row(name, paths, stages * per_path, whole * per_path, whole / stages);
        }
        csv.write();
    }
} catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
