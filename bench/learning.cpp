// Queries that learn (Bvh::Config::learns) beside queries of the tree that was built, and of the best one:
// bench_learning
// [--device D] [--builder fast|balanced] [--seconds S] [--size WIDTH HEIGHT] [--kinds primary shadow bounce random]
// [--csv FILE] SCENE... All kinds of rays are traced in turn. SCENE is as for bench_trace.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string selector;
    Builder builder = Builder::automatic;
    double seconds = 10;
    std::vector<unsigned> size = {1920, 1080};
    std::vector<std::string> kinds = {"primary", "shadow", "bounce", "random"};
};

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// A structure whose rays are traced for some time.
struct Run {
    const char* name;
    Bvh::Config config;
    double build = 0;                 // seconds
    double replaced_at = 0;           // seconds of tracing after which the first batch met another tree; 0: none did
    std::vector<double> rounds = {};  // seconds of each, in which all kinds are traced once
    std::size_t first_after = 0;

    /// Rounds a second from `begin` on, by the median.
    [[nodiscard]] double rate(std::size_t begin, std::size_t end) const {
        return begin < end ? 1 / measure::median({rounds.begin() + long(begin), rounds.begin() + long(end)}) : 0;
    }
};

void trace(const Device& device, const std::vector<Mesh>& meshes, std::vector<measure::DeviceRays>& sets,
           double seconds, Run& run) {
    static_cast<void>(Bvh::build(device, meshes, run.config));  // compiles
    device.finish();
    double from = now();
    const Bvh bvh = Bvh::build(device, meshes, run.config);
    device.finish();
    run.build = now() - from;
    for (double traced = 0; traced < seconds;) {
        const bool was_replaced = bvh.is_replaced();
        from = now();
        for (measure::DeviceRays& rays : sets) rays.trace(bvh);
        device.finish();
        run.rounds.push_back(now() - from);
        traced += run.rounds.back();
        if (!was_replaced && bvh.is_replaced()) run.replaced_at = traced, run.first_after = run.rounds.size();
    }
}

/// Rounds done within the time, with the build.
double rounds_within(const Run& run, double seconds) {
    double at = run.build, done = 0;
    for (const double round : run.rounds) {
        if (at + round > seconds) return done + (at < seconds ? (seconds - at) / round : 0);
        at += round, done += 1;
    }
    return done;
}

void report(const Device& device, const std::string& name, const Options& options, measure::Csv& csv) {
    const std::vector<Mesh> meshes = measure::load_meshes(name);
    std::vector<measure::DeviceRays> sets =
        measure::upload_rays(device, name, meshes, options.size[0], options.size[1]);
    std::erase_if(sets, [&](const measure::DeviceRays& rays) {
        return std::find(options.kinds.begin(), options.kinds.end(), rays.name) == options.kinds.end();
    });
    Run runs[] = {{"first", {.builder = options.builder, .learns = false}},
                  {"learning", {.builder = options.builder, .learns = true}},
                  {"high", {.builder = Builder::high, .learns = false}}};
    Run warm_up = runs[0];
    trace(device, meshes, sets, 0.1, warm_up);
    for (Run& run : runs) trace(device, meshes, sets, options.seconds, run);
    const Run &first = runs[0], &learning = runs[1], &high = runs[2];
    const double before = first.rate(0, first.rounds.size());
    const double after = learning.rate(learning.first_after, learning.rounds.size());
    const double all = rounds_within(learning, options.seconds) / rounds_within(first, options.seconds);
    const double best = rounds_within(high, options.seconds) / rounds_within(first, options.seconds);
    const double longest = *std::max_element(learning.rounds.begin(), learning.rounds.end());
    std::printf("%s: build %.3f s, high %.3f s; ", name.c_str(), first.build, high.build);
    if (learning.replaced_at > 0)
        std::printf("replaced after %.2f s, then %.3f times as fast; ", learning.replaced_at, after / before);
    else
        std::printf("not replaced; ");
    std::printf("high %.3f; longest round %.1f ms, median %.1f; in %.0f s with builds %.3f times the rays, high %.3f\n",
                high.rate(0, high.rounds.size()) / before, longest * 1e3, 1e3 / before, options.seconds, all, best);
    std::fflush(stdout);
    csv.row(name, first.build, high.build, learning.replaced_at, after / before, longest, all, best);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times queries that replace their tree by a better one");
    Options options;
    std::string csv_path;
    std::vector<std::string> scenes = {"hall", "terrain:100000"};
    app.add_option("--device", options.selector);
    app.add_option("--builder", options.builder)->transform(CLI::CheckedTransformer(measure::builders_and_automatic()));
    app.add_option("--seconds", options.seconds)->check(CLI::PositiveNumber);
    app.add_option("--size", options.size)->expected(2);
    app.add_option("--kinds", options.kinds);
    app.add_option("--csv", csv_path);
    app.add_option("scenes", scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.selector);
    std::printf("%s, driver %s; rays of all kinds in turn, by wall-clock time\n", device.info().name.c_str(),
                device.info().driver.c_str());
    measure::Csv csv(csv_path, device,
                     "scene,build_seconds,high_build_seconds,replaced_after_seconds,speed_after,longest_round_seconds,"
                     "rays_with_builds,rays_of_high_with_builds");
    for (const std::string& name : scenes) report(device, name, options, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_learning: error: %s\n", error.what());
    return 1;
}
