// Build times stage by stage: bench_build [--device D] [--builder fast|balanced|high] [--bits 30|63] [--repeat N]
// [--csv FILE] [SCENE...]
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

void report(const Device& device, const std::string& name, const Bvh::Config& config, int repeat, measure::Csv& csv) {
    Bvh bvh = Bvh::build(device, measure::load_meshes(name), config);
    const auto medians = measure::measure(device, repeat, [&] { bvh.rebuild(); });
    const BvhStatistics s = bvh.statistics();
    const auto refit = measure::measure(device, repeat, [&] { bvh.refit(); });
    bvh.rebuild();
    const double total = medians.at("");
    std::printf(
        "%s: %u triangles, %u-bit codes: %.3f ms, %.0f Mtri/s; refit %.3f ms; SAH %.2f, height %u, %.1f MB, hash %s, "
        "%s\n",
        name.c_str(), s.triangles, config.morton_bits, total, s.triangles * 1e-3 / total, refit.at(""), s.sah_cost,
        s.height, double(s.bytes) * 1e-6, bvh.hash().c_str(), bvh.validate().ok() ? "valid" : "INVALID");
    for (const auto& [stage, ms] : medians)
        csv.row(name, s.triangles, config.morton_bits, stage.empty() ? "all" : stage, ms, s.sah_cost, s.bytes);
    csv.row(name, s.triangles, config.morton_bits, "refit", refit.at(""), s.sah_cost, s.bytes);
    for (const auto& [stage, ms] : medians)
        if (!stage.empty()) std::printf("    %-24s %8.3f ms\n", stage.c_str(), ms);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times the build of the acceleration structure");
    std::string selector, csv_path;
    std::vector<std::string> scenes = {"soup:100000", "terrain:1000000"};
    Bvh::Config config;
    int repeat = 11;
    app.add_option("--device", selector);
    measure::add_bvh_options(app, config);
    app.add_option("--repeat", repeat);
    app.add_option("--csv", csv_path);
    app.add_option("scenes", scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(selector);
    std::printf("%s, driver %s; medians of %d by OpenCL events\n", device.info().name.c_str(),
                device.info().driver.c_str(), repeat);
    measure::Csv csv(csv_path, device, "scene,triangles,bits,stage,milliseconds,sah_cost,bytes");
    for (const std::string& scene : scenes) report(device, scene, config, repeat, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_build: error: %s\n", error.what());
    return 1;
}
