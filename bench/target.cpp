// What choosing by target holds of what it promises, at small sizes:
//   bench_target coverage [--size N] [--seeds N] [--references FOLDER]
// coverage: renders to an error, of five scenes and three targets, against references: how many reach it, and by how
// much.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/support.hpp"
#include "claray/accuracy.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv, references;
    unsigned size = 48, seeds = 7;
};

constexpr const char* scenes[] = {"cornell", "spheres", "crate", "hills", "terrain:2000"};
constexpr double targets[] = {0.08, 0.04, 0.02};

Scene scene_of(const std::string& name) {
    Warnings warnings;
    return load_scene(name, warnings);
}

/// The reference's own error is taken away: both are independent.
double true_error(const std::vector<glm::vec3>& image, const ReferenceImage& reference, unsigned width) {
    const double all = image_error(image, reference.pixels, width).rmse, own = reference.uncertainty;
    return std::sqrt(std::max(all * all - own * own, 0.0));
}

ReferenceImage reference_of(const Device& device, const Scene& scene, const Options& options, double error) {
    return reference_image(device, scene, {.width = options.size, .height = options.size},
                           {.least_spp = 4096, .uncertainty = error, .folder = options.references});
}

void coverage(const Device& device, const Options& options) {
    bench::Csv csv(options.csv, device, "scene,target,seed,spp,estimate,bound,error");
    unsigned runs = 0, held = 0, wasteful = 0;
    double least = INFINITY;
    std::printf("%-14s %7s %6s %9s %9s %9s %9s\n", "scene", "target", "held", "least/E", "median/E", "most/E", "spp");
    for (const char* name : scenes) {
        const Scene scene = scene_of(name);
        const ReferenceImage reference = reference_of(device, scene, options, targets[2] / 8);
        for (const double target : targets) {
            std::vector<double> ratios, spp;
            for (unsigned seed = 0; seed < options.seeds; ++seed) {
                Renderer renderer(device, scene,
                                  {.width = options.size,
                                   .height = options.size,
                                   .spp = 1u << 24,
                                   .seed = 1000 + seed,
                                   .error = target});
                const RenderProgress reached = renderer.render();
                const double error = true_error(renderer.image(), reference, options.size);
                csv.row(name, target, seed, reached.spp, reached.error, reached.error_bound, error);
                ratios.push_back(error / target), spp.push_back(reached.spp);
                if (reached.spp > 4 && error < target / 3) ++wasteful;
                if (reached.spp > 4) least = std::min(least, error / target);
            }
            const auto good = unsigned(std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 1; }));
            runs += options.seeds, held += good;
            const auto [low, high] = std::minmax_element(ratios.begin(), ratios.end());
            std::printf("%-14s %7.3f %4u/%u %9.3f %9.3f %9.3f %9.0f\n", name, target, good, options.seeds, *low,
                        bench::median(ratios), *high, bench::median(spp));
            std::fflush(stdout);
        }
    }
    std::printf(
        "%u of %u runs are within their target; the least error is %.2f of it where there are more than 4 spp, "
        "%u are below a third\n",
        held, runs, least, wasteful);
    csv.write();
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("What choosing by target holds of what it promises");
    Options options;
    app.require_subcommand(1);
    app.fallthrough();
    app.add_option("--device", options.device, "cpu, gpu, an index or a part of the name");
    app.add_option("--size", options.size, "Pixels a side [48]");
    app.add_option("--seeds", options.seeds, "Renders of each scene and target [7]");
    app.add_option("--references", options.references, "Where references are kept");
    app.add_option("--csv", options.csv, "Write the results to FILE");
    const auto add = [&](const char* name, const char* what, auto run) {
        app.add_subcommand(name, what)->final_callback([&options, run] { run(Device::open(options.device), options); });
    };
    add("coverage", "Errors reached against errors asked for", coverage);
    CLI11_PARSE(app, argc, argv);
    return 0;
} catch (const Error& error) {
    std::fprintf(stderr, "bench_target: %s\n", error.what());
    return int(error.kind());
}
