// What a live view waits for, in milliseconds of the wall clock (medians):
//   bench_live [--device D] [--scenes NAME...] [--size WIDTH HEIGHT] [--lights N] [--rounds N] [--csv FILE]
// Each change is timed alone, then as a whole frame: change, one sample per pixel, and the picture on the host.
#include <cstdio>
#include <functional>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv;
    std::vector<std::string> scenes = {"cornell", "crate", "spheres", "hills", "sponza.obj"};
    std::pair<unsigned, unsigned> size = {640, 360};
    unsigned lights = 1000;
    int rounds = 15;
};

using Clock = std::chrono::steady_clock;

double median_ms(const Device& device, int rounds, const std::function<void()>& act) {
    std::vector<double> times;
    for (int i = 0; i < rounds + 2; ++i) {
        device.finish();
        const Clock::time_point begin = Clock::now();
        act();
        if (i >= 2) times.push_back(1e3 * std::chrono::duration<double>(Clock::now() - begin).count());
    }
    std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
    return times[std::size_t(rounds) / 2];
}

/// Points and spots in turn, spread through the scene.
void add_lights(Scene& scene, unsigned count) {
    const Bounds bounds = bounds_of(scene);
    std::uint32_t word = 1;
    const auto next = [&] { return float(word = word * 1664525u + 1013904223u) * 0x1p-32f; };
    for (unsigned i = 0; i < count; ++i) {
        Light light = point_light(bounds.lo + glm::vec3(next(), next(), next()) * bounds.extent(), glm::vec3(1));
        if (i % 2 == 1) light.kind = LightKind::spot;
        light.range = 0.1f * glm::length(bounds.extent());
        scene.lights.push_back(light);
    }
}

struct Task {
    const char* name;
    std::function<void()> act;
};

std::vector<Task> tasks_of(Renderer& renderer, Scene& scene) {
    const auto update = [&](const SceneChanges& changes) { return [&, changes] { renderer.update(scene, changes); }; };
    const auto frame = [&](const SceneChanges& changes) {
        return [&, changes] {
            renderer.update(scene, changes);
            (void)renderer.render();
            (void)renderer.picture();
        };
    };
    std::vector<Task> tasks = {{"restart", [&] { renderer.restart(1); }},
                               {"camera", update({.camera = true})},
                               {"lights", update({.lights = true})},
                               {"materials", update({.materials = true})},
                               {"vertices", update({.vertices = true})}};
    if (!scene.instances.empty()) tasks.push_back({"instances", update({.instances = true})});
    tasks.push_back({"picture", [&] { (void)renderer.picture(); }});
    tasks.push_back({"image", [&] { (void)renderer.image(); }});
    tasks.push_back({"image, kept memory", [&, to = renderer.image()]() mutable { renderer.image(to); }});
    tasks.push_back({"radiance", [&] { (void)renderer.radiance(); }});
    tasks.push_back({"aovs", [&] { (void)renderer.aovs(); }});
    tasks.push_back({"frame after camera", frame({.camera = true})});
    tasks.push_back({"frame after lights", frame({.lights = true})});
    tasks.push_back({"frame after materials", frame({.materials = true})});
    return tasks;
}

void report(const Device& device, const Options& options, const std::string& name, measure::Csv& csv) {
    Warnings warnings;
    Scene scene = load_scene(name, warnings);
    scene.camera = camera_of(scene, float(options.size.first) / float(options.size.second));
    add_lights(scene, options.lights);
    Renderer renderer(device, scene, {.width = options.size.first, .height = options.size.second, .spp = 1});
    renderer.settle();
    for (const Task& task : tasks_of(renderer, scene)) {
        const double milliseconds = median_ms(device, options.rounds, task.act);
        std::printf("%-20s %-22s %9.3f ms\n", name.c_str(), task.name, milliseconds);
        csv.row(name, options.size.first, options.size.second, options.lights, task.name, milliseconds);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times what a live view waits for");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--scenes", options.scenes);
    app.add_option("--size", options.size, "pixels: width and height [640 360]");
    app.add_option("--lights", options.lights, "points and spots that are added [1000]");
    app.add_option("--rounds", options.rounds);
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    measure::Csv csv(options.csv, device, "scene,width,height,lights,task,milliseconds");
    for (const std::string& scene : options.scenes) report(device, options, scene, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_live: error: %s\n", error.what());
    return 1;
}
