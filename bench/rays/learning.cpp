// Queries that learn (Bvh::Config::learns) beside queries of the tree that was built, and of the best one:
// bench_learning [SCENE...] [--device D] [--builder fast|balanced] [--seconds S] [--size WIDTH HEIGHT]
// [--kinds primary shadow bounce random] [--csv FILE]. All kinds of rays are traced in turn, and the three structures
// in turn. SCENE is as for bench_trace.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>

#include "bench/support.hpp"
#include "host/base/seconds_since.hpp"

using namespace claray;

namespace {

struct Options {
    std::string selector;
    Builder builder = Builder::automatic;
    double seconds = 10;
    std::vector<unsigned> size = {1920, 1080};
    std::vector<std::string> kinds = {"primary", "shadow", "bounce", "random"};
};

using Clock = std::chrono::steady_clock;

/// A structure whose rays are traced for some time.
struct Run {
    Bvh bvh;
    double build = 0;                 // seconds
    std::vector<double> rounds = {};  // seconds of each, in which all kinds are traced once

    Run(const Device& device, const std::vector<Mesh>& meshes, const Bvh::Config& config) {
        static_cast<void>(Bvh::build(device, meshes, config));  // compiles
        device.finish();
        const Clock::time_point from = Clock::now();
        bvh = Bvh::build(device, meshes, config);
        device.finish();
        build = seconds_since(from);
    }
    void trace(std::vector<measure::DeviceRays>& sets) {
        const Clock::time_point from = Clock::now();
        for (measure::DeviceRays& rays : sets) rays.trace(bvh);
        bvh.device().finish();
        rounds.push_back(seconds_since(from));
    }
    [[nodiscard]] double seconds() const { return std::accumulate(rounds.begin(), rounds.end(), build); }
};

/// Median over the rounds from `begin` on of the speed relative to that of `other`, which was traced in turn.
double speed_over(const Run& run, const Run& other, std::size_t begin) {
    std::vector<double> ratios;
    for (std::size_t i = begin; i < run.rounds.size(); ++i) ratios.push_back(other.rounds[i] / run.rounds[i]);
    return measure::median(ratios);
}

void report(const Device& device, const std::string& name, const Options& options, measure::Csv& csv) {
    const std::vector<Mesh> meshes = measure::load_meshes(name);
    std::vector<measure::DeviceRays> sets =
        measure::upload_rays(device, name, meshes, options.size[0], options.size[1]);
    std::erase_if(sets, [&](const measure::DeviceRays& rays) {
        return std::find(options.kinds.begin(), options.kinds.end(), rays.name) == options.kinds.end();
    });
    Run first(device, meshes, {.builder = options.builder, .learns = false});
    Run learning(device, meshes, {.builder = options.builder, .learns = true});
    Run high(device, meshes, {.builder = Builder::high, .learns = false});
    double replaced_at = 0;
    std::size_t first_after = 0;
    while (learning.seconds() < options.seconds) {
        for (Run* run : {&first, &learning, &high}) run->trace(sets);
        if (first_after != 0 || !is_replaced(learning.bvh)) continue;
        first_after = learning.rounds.size(), replaced_at = learning.seconds();
    }
    const double gain = first_after != 0 ? speed_over(learning, first, first_after) : 1;
    const double longest = *std::max_element(learning.rounds.begin(), learning.rounds.end());
    const double of_high = speed_over(high, first, 1), total = learning.seconds() / first.seconds();
    std::printf("%s: build %.3f s, high %.3f s; ", name.c_str(), first.build, high.build);
    if (first_after != 0)
        std::printf("replaced after %.2f s, then %.3f times as fast (high: %.3f); ", replaced_at, gain, of_high);
    else
        std::printf("not replaced (high: %.3f); ", of_high);
    std::printf("round of %.1f ms, longest %.1f ms; all rounds with builds took %.3f of the time\n",
                1e3 * measure::median(first.rounds), 1e3 * longest, total);
    std::fflush(stdout);
    csv.row(name, first.build, high.build, replaced_at, gain, of_high, measure::median(first.rounds), longest, total);
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
                     "scene,build_seconds,high_build_seconds,replaced_after_seconds,speed_after,speed_of_high,"
                     "round_seconds,longest_round_seconds,time_with_builds");
    for (const std::string& name : scenes) report(device, name, options, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_learning: error: %s\n", error.what());
    return 1;
}
