// The grid of light: device time of filling it and of frames that look it up, in milliseconds (medians over rounds):
//   bench_light_grid [--device D] [--scene NAME] [--size WIDTH HEIGHT] [--rounds N] [--csv FILE]
//                    [--camera X Y Z --target X Y Z]
// fill: one update of 16^3 probes with 64 rays each, and of two levels of 32^3 voxels; cells: what the parts of 16^3
// cells see. frame: one sample per pixel of direct light (depth 1), and with the light of the grid, interleaved.
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv, scene = "cornell";
    std::pair<unsigned, unsigned> size = {640, 360};
    std::vector<float> camera, target;
    int rounds = 9;
};

double median_of(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

/// Milliseconds of all kernels that `work` runs.
template <class Work>
double kernels_of(const Device& device, const Work& work) {
    device.profiler().reset();
    work();
    double all = 0;
    for (const auto& [name, summary] : device.profiler().summary())
        if (name != "write_buffer" && name != "read_buffer") all += summary.milliseconds;
    return all;
}

/// An image of few pixels, so that its time hardly counts.
RenderConfig few_pixels(const LightGridConfig& grid) {
    return {.width = 4, .height = 4, .spp = 1, .approximate = {.light_grid = true}, .light_grid = grid};
}

/// Time of an update after the light changed, or the surfaces.
double fill_time(const Device& device, const Scene& scene, const LightGridConfig& grid, bool surfaces, int rounds) {
    Renderer renderer(device, scene, few_pixels(grid));
    renderer.settle();
    SceneChanges change;
    change.materials = !surfaces;
    change.instances = surfaces && !scene.instances.empty(), change.vertices = surfaces && scene.instances.empty();
    std::vector<double> times;
    for (int i = 0; i < rounds + 2; ++i) {
        renderer.update(scene, change);
        const double time = kernels_of(device, [&] { (void)renderer.render(); });
        if (i >= 2) times.push_back(time);
    }
    return median_of(times);
}

std::pair<double, double> frame_times(const Device& device, const Scene& scene, const Options& options) {
    RenderConfig direct{.width = options.size.first, .height = options.size.second, .spp = 1, .max_depth = 1};
    RenderConfig grid = direct;
    grid.max_depth = default_max_depth, grid.approximate.light_grid = true;
    Renderer renderers[] = {{device, scene, direct}, {device, scene, grid}};
    std::vector<double> times[2];
    for (Renderer& renderer : renderers) renderer.settle();
    for (int i = 0; i < options.rounds + 2; ++i)
        for (int k = 0; k < 2; ++k) {
            renderers[k].restart(std::uint32_t(i));
            const double time = kernels_of(device, [&] { (void)renderers[k].render(); });
            if (i >= 2) times[k].push_back(time);
        }
    return {median_of(times[0]), median_of(times[1])};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times of the grid of light");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--scene", options.scene);
    app.add_option("--size", options.size, "pixels of the frames: width and height [640 360]");
    app.add_option("--camera", options.camera, "its position")->expected(3);
    app.add_option("--target", options.target, "where it looks")->expected(3);
    app.add_option("--rounds", options.rounds);
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    Warnings warnings;
    Scene scene = load_scene(options.scene, warnings);
    scene.camera = camera_of(scene, float(options.size.first) / float(options.size.second));
    const auto vector = [](const std::vector<float>& v) { return glm::vec3(v[0], v[1], v[2]); };
    if (!options.camera.empty()) scene.camera->position = vector(options.camera);
    if (!options.target.empty()) scene.camera->target = vector(options.target);
    measure::Csv csv(options.csv, device, "scene,what,milliseconds");
    const auto row = [&](const char* what, double milliseconds) {
        std::printf("%-44s %9.3f ms\n", what, milliseconds);
        csv.row(options.scene, what, milliseconds);
    };
    row("16^3 probes with 64 rays each", fill_time(device, scene, {}, false, options.rounds));
    row("the same, and what the parts of cells see", fill_time(device, scene, {}, true, options.rounds));
    row("two levels of 32^3 voxels",
        fill_time(device, scene, {.voxels = true, .side = 32, .levels = 2}, false, options.rounds));
    const auto [direct, grid] = frame_times(device, scene, options);
    row("frame, direct light alone", direct);
    row("frame with the light grid", grid);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_light_grid: error: %s\n", error.what());
    return 1;
}
