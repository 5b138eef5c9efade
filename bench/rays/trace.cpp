// Rays a second: bench_trace [--device D] [--builder fast|balanced|high] [--layout binary|wide] [--bits 30|63]
// [--repeat N]
// [--hints] [--csv FILE] [SCENE...] --hints tells the queries which rays are coherent, as the renderer does, instead of
// letting them find out. SCENE is a built-in name, an OBJ, or NAME.scn with NAME.ray (three kinds of rays) and
// NAME.ref (their hits) beside it.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string selector;
    Bvh::Config bvh;
    unsigned width = 1920, height = 1080;
    int repeat = 11;
    bool hints = false;
};

double closest_mrays(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits, int repeat,
                     Coherence coherence = Coherence::automatic) {
    QueryOptions query;
    query.coherence = coherence;
    const auto ms = measure::measure(bvh.device(), repeat, [&] { closest_hit(bvh, rays, hits, query); });
    return double(rays.size()) * 1e-3 / ms.at("closest_hit");
}

double any_mrays(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, int repeat) {
    const auto ms = measure::measure(bvh.device(), repeat, [&] { any_hit(bvh, rays, occluded); });
    return double(rays.size()) * 1e-3 / ms.at("any_hit");
}

/// Rays whose hit is not at the reference's distance to 1e-3 of it; 1e30 stands for a miss.
std::size_t count_differences(const std::vector<Hit>& hits, const float* reference) {
    std::size_t differences = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const bool missed = hits[i].primitive == CLARAY_MISS, expected_miss = reference[i] > 1e29f;
        differences += missed != expected_miss ||
                       (!missed && std::fabs(hits[i].t - reference[i]) > 1e-3f * std::max(1.f, reference[i]));
    }
    return differences;
}

void trace_recorded(const Device& device, const Bvh& bvh, const std::string& name, const Options& options,
                    measure::Csv& csv) {
    const std::string stem = name.substr(0, name.size() - 4);
    const auto words = measure::read_words(stem + ".ray"), reference = measure::read_words(stem + ".ref");
    const std::size_t n0 = words.at(1), n1 = words.at(2), n2 = words.at(3);
    const auto* rays = reinterpret_cast<const Ray*>(&words.at(4));
    const auto* t0 = reinterpret_cast<const float*>(&reference.at(4));
    const auto* occluded_reference = reinterpret_cast<const std::uint8_t*>(t0 + n0);
    std::vector<float> t2(n2);
    std::memcpy(t2.data(), occluded_reference + n1, n2 * sizeof(float));

    const Buffer<Ray> primary(device, std::span(rays, n0)), shadow(device, std::span(rays + n0, n1)),
        bounce(device, std::span(rays + n0 + n1, n2));
    Buffer<Hit> hits(device, n0), bounce_hits(device, n2);
    Buffer<std::uint8_t> occluded(device, n1);
    const auto hint = [&](Coherence known) { return options.hints ? known : Coherence::automatic; };
    const double mrays[3] = {closest_mrays(bvh, primary, hits, options.repeat, hint(Coherence::coherent)),
                             any_mrays(bvh, shadow, occluded, options.repeat),
                             closest_mrays(bvh, bounce, bounce_hits, options.repeat, hint(Coherence::incoherent))};
    const std::vector<std::uint8_t> occluded_found = occluded.read();
    std::size_t shadow_differences = 0;
    for (std::size_t i = 0; i < n1; ++i) shadow_differences += (occluded_found[i] != 0) != (occluded_reference[i] != 0);
    std::printf("%s: primary %.1f, shadow %.1f, bounce %.1f Mrays/s; differences %zu of %zu, %zu of %zu, %zu of %zu\n",
                name.c_str(), mrays[0], mrays[1], mrays[2], count_differences(hits.read(), t0), n0, shadow_differences,
                n1, count_differences(bounce_hits.read(), t2.data()), n2);
    csv.row(name, "primary", n0, mrays[0]);
    csv.row(name, "shadow", n1, mrays[1]);
    csv.row(name, "bounce", n2, mrays[2]);
}

void trace_generated(const Device& device, const Bvh& bvh, const std::vector<Mesh>& meshes, const std::string& name,
                     const Options& options, measure::Csv& csv) {
    Scene scene;
    scene.meshes = meshes;
    Camera camera = automatic_camera(bounds_of(scene), 40.f, float(options.width) / float(options.height));
    if (const auto builtin = builtin_scene(name); builtin && builtin->camera) camera = *builtin->camera;
    const std::size_t count = std::size_t(options.width) * options.height;
    const Buffer<Ray> scanline(device, measure::primary_rays(camera, options.width, options.height, false));
    const Buffer<Ray> tiles(device, measure::primary_rays(camera, options.width, options.height, true));
    const Buffer<Ray> random(device, measure::random_rays(bounds_of(scene), count));
    Buffer<Hit> hits(device, count);
    Buffer<std::uint8_t> occluded(device, count);
    const double mrays[4] = {
        closest_mrays(bvh, scanline, hits, options.repeat), closest_mrays(bvh, tiles, hits, options.repeat),
        closest_mrays(bvh, random, hits, options.repeat), any_mrays(bvh, random, occluded, options.repeat)};
    std::printf("%s: primary %.1f (tiles %.1f), random %.1f, random any hit %.1f Mrays/s\n", name.c_str(), mrays[0],
                mrays[1], mrays[2], mrays[3]);
    const char* kinds[4] = {"primary", "primary tiles", "random", "random any hit"};
    for (int i = 0; i < 4; ++i) csv.row(name, kinds[i], count, mrays[i]);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times rays against the acceleration structure");
    Options options;
    std::string csv_path;
    std::vector<std::string> scenes = {"cornell", "spheres", "soup:100000", "terrain:1000000"};
    app.add_option("--device", options.selector);
    app.add_option("--repeat", options.repeat);
    app.add_option("--width", options.width);
    app.add_option("--height", options.height);
    measure::add_bvh_options(app, options.bvh);
    app.add_flag("--hints", options.hints);
    app.add_option("--csv", csv_path);
    app.add_option("scenes", scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.selector);
    std::printf("%s, driver %s; medians of %d by OpenCL events\n", device.info().name.c_str(),
                device.info().driver.c_str(), options.repeat);
    measure::Csv csv(csv_path, device, "scene,kind,rays,mrays_per_second");
    for (const std::string& name : scenes) {
        const std::vector<Mesh> meshes = measure::load_meshes(name);
        const Bvh bvh = Bvh::build(device, meshes, options.bvh);
        if (name.ends_with(".scn"))
            trace_recorded(device, bvh, name, options, csv);
        else
            trace_generated(device, bvh, meshes, name, options, csv);
    }
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_trace: error: %s\n", error.what());
    return 1;
}
