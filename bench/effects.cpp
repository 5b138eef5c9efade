// What kernels that hold only what a scene calls for gain over kernels that know every effect: the time of a frame and
// of compiling, and device memory, for every built-in scene.
//   bench_effects [--scenes NAME...] [--side PIXELS] [--rounds N] [--builder NAME] [--csv FILE]
#include <cstdio>

#include "bench/support.hpp"
#include "host/measure/explain.hpp"

using namespace claray;

namespace {

std::vector<std::string> all_scenes() {
    std::vector<std::string> scenes = {"cornell",     "spheres",   "crate",      "hills",  "terrain:100000",
                                       "soup:100000", "fan:10000", "hair:50000", "effects"};
    for (const Effect effect : all_effects()) scenes.push_back(std::string("effect:") + name_of(effect));
    return scenes;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Kernels for the scene's effects against kernels for all effects");
    std::string selector, csv_path;
    std::vector<std::string> scenes = all_scenes();
    unsigned side = 256;
    measure::ExplainOptions options;
    options.only = {};
    app.add_option("--device", selector);
    app.add_option("--scenes", scenes);
    app.add_option("--side", side, "pixels a side [256]");
    app.add_option("--rounds", options.rounds);
    app.add_flag("!--no-compile-times", options.compile_times);
    Bvh::Config bvh = RenderConfig().bvh;
    app.add_option("--builder", bvh.builder)->transform(CLI::CheckedTransformer(measure::builders));
    app.add_option("--csv", csv_path);
    CLI11_PARSE(app, argc, argv);

    const Device device = Device::open(selector);
    measure::Csv csv(csv_path, device, "scene,own_ms,full_ms,full_over_own,own_compile_ms,full_compile_ms,own_bytes");
    std::printf("%-26s %10s %10s %7s %12s %12s %8s\n", "scene", "own ms", "all ms", "ratio", "compile own",
                "compile all", "MB");
    for (const std::string& name : scenes) {
        Warnings warnings;
        const measure::Explanation x = measure::explain(
            device, load_scene(name, warnings), {.width = side, .height = side, .max_depth = 8, .bvh = bvh}, options);
        std::printf("%-26s %10.3f %10.3f %7.3f %12.0f %12.0f %8.1f\n", name.c_str(), x.own.milliseconds,
                    x.full.milliseconds, x.full_ratio, x.own.compile_milliseconds, x.full.compile_milliseconds,
                    double(x.own.bytes) * 1e-6);
        std::fflush(stdout);
        csv.row(name, x.own.milliseconds, x.full.milliseconds, x.full_ratio, x.own.compile_milliseconds,
                x.full.compile_milliseconds, x.own.bytes);
        csv.write();
    }
} catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
