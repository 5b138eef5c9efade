// The Cornell box, 512 x 512 at 256 samples a pixel, against a reference of 65,536 by the same program with another
// seed:
//   bench_cornell [--device D] [--spp N] [--reference-spp N] [--reference R,G,B] [--csv FILE]
// The reference takes a GPU about a minute and a CPU hours; --reference gives one that is known already.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv;
    unsigned size = 512, spp = 256, reference_spp = 65536;
    std::vector<double> reference;
};

struct Result {
    glm::dvec3 mean{0.0};
    RenderProgress progress;
    RenderStatistics statistics;
    [[nodiscard]] double samples(unsigned size) const { return double(progress.spp) * size * size; }
};

Result render_cornell(const Device& device, const Options& options, unsigned spp, std::uint32_t seed) {
    Renderer renderer(device, *builtin_scene("cornell"),
                      {.width = options.size, .height = options.size, .spp = spp, .seed = seed});
    Result result;
    result.progress = renderer.render();
    result.statistics = renderer.statistics();
    const std::vector<glm::vec3> image = renderer.image();
    for (const glm::vec3& pixel : image) result.mean += glm::dvec3(pixel) / double(image.size());
    return result;
}

void print(const char* name, const Result& result, const Options& options) {
    std::printf("%-10s %6u spp  %9.6f %9.6f %9.6f  noise %.3f %%  %8.2f s  %8.2f Msamples/s\n", name,
                result.progress.spp, result.mean.x, result.mean.y, result.mean.z, 100 * result.progress.noise,
                result.progress.seconds, result.samples(options.size) * 1e-6 / result.progress.seconds);
}

double largest_difference(const glm::dvec3& ratio) {
    return std::max({std::abs(ratio.x - 1), std::abs(ratio.y - 1), std::abs(ratio.z - 1)});
}

void write_csv(const Options& options, const Device& device, const Result& image, const glm::dvec3& ratio) {
    char row[512];
    std::snprintf(row, sizeof row,
                  "device,size,spp,seconds,msamples_per_second,noise,red,green,blue,ratio_red,ratio_green,ratio_blue\n"
                  "%s,%u,%u,%.4f,%.4f,%.6f,%.7f,%.7f,%.7f,%.6f,%.6f,%.6f\n",
                  device.info().name.c_str(), options.size, image.progress.spp, image.progress.seconds,
                  image.samples(options.size) * 1e-6 / image.progress.seconds, image.progress.noise, image.mean.x,
                  image.mean.y, image.mean.z, ratio.x, ratio.y, ratio.z);
    write_file(options.csv, row);
}

/// Exit code: 0 where the means agree to half a per cent.
int run(const Options& options) {
    const Device device = Device::open(options.device);
    std::printf("%s, cornell %ux%u\n", device.info().name.c_str(), options.size, options.size);
    (void)render_cornell(device, options, 1, 0);  // compiles the kernels
    const Result image = render_cornell(device, options, options.spp, 0);
    print("image", image, options);
    glm::dvec3 reference;
    if (options.reference.empty()) {
        const Result converged = render_cornell(device, options, options.reference_spp, 1);
        print("reference", converged, options);
        reference = converged.mean;
    } else {
        reference = {options.reference[0], options.reference[1], options.reference[2]};
        std::printf("%-10s %10s  %9.6f %9.6f %9.6f\n", "reference", "given", reference.x, reference.y, reference.z);
    }
    const glm::dvec3 ratio = image.mean / reference;
    const double worst = largest_difference(ratio);
    std::printf("ratio                  %9.6f %9.6f %9.6f  %s half a per cent\n", ratio.x, ratio.y, ratio.z,
                worst <= 0.005 ? "within" : "NOT within");
    if (!options.csv.empty()) write_csv(options, device, image, ratio);
    return worst <= 0.005 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Mean radiance and speed of the Cornell box");
    Options options;
    app.add_option("--device", options.device, "cpu, gpu, an index or part of a name");
    app.add_option("--size", options.size, "Pixels a side [512]");
    app.add_option("--spp", options.spp, "Samples per pixel [256]");
    app.add_option("--reference-spp", options.reference_spp, "Samples per pixel of the reference [65536]");
    app.add_option("--reference", options.reference, "R,G,B: the mean radiance of a known reference")
        ->delimiter(',')
        ->expected(3);
    app.add_option("--csv", options.csv, "Write the result to FILE");
    CLI11_PARSE(app, argc, argv);
    return run(options);
} catch (const Error& error) {
    std::fprintf(stderr, "bench_cornell: %s\n", error.what());
    return int(error.kind());
}
