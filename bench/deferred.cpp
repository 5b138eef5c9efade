// Frames under many moving lights: device time of each kernel, in milliseconds (medians over frames):
//   bench_deferred [--device D] [--scene NAME] [--size WIDTH HEIGHT] [--lights N] [--range METRES] [--equal]
//                  [--camera X Y Z --target X Y Z] [--frames NAME...] [--rounds N] [--csv FILE]
//                  [--noise [--tree] [--spp N] [--depth N]]
// Half of the lights are points, half are spots. Every frame moves all of them. The frames are
//   tile-sum    all lights without shadows, by the lists of tiles (Approximations::tile_sum)
//   all-lights  the same with lists of all lights
//   pick        one light per pixel from the list of its place, with a shadow ray: the path tracer with depth 1
// --noise prints the noise of --spp samples per pixel of paths of --depth surfaces instead: the standard deviation over
// --rounds images, over their mean, and that mean. With --tree the light tree picks, not the lists. The noise of `pick`
// includes the variation of light within pixels, which vanishes in images of several times the size.
#include <cstdio>
#include <random>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv, scene = "sponza.obj";
    std::pair<unsigned, unsigned> size = {640, 360};
    unsigned lights = 1000;
    float range = 2.5f;
    bool equal = false, noise = false, tree = false;
    unsigned spp = 16, depth = 1;
    std::vector<float> camera, target;
    std::vector<std::string> frames = {"tile-sum", "all-lights", "pick"};
    int rounds = 9;
};

double median_of(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

std::vector<Light> lights_within(const Bounds& bounds, unsigned count, float range) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> uniform;
    const auto random = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
    std::vector<Light> lights;
    for (unsigned i = 0; i < count; ++i) {
        lights.push_back(point_light(bounds.lo + random() * bounds.extent(), 2.f * random()));
        if (i % 2 == 1) lights.back().kind = LightKind::spot, lights.back().direction = random() - 0.5f;
        lights.back().inner_angle = 0.3f, lights.back().outer_angle = 0.5f, lights.back().range = range;
    }
    return lights;
}

struct Method {
    const char* name;
    Approximations approximate;
    bool all_lights = false;
};
constexpr Method methods[] = {{"tile-sum", {.tile_sum = true}}, {"all-lights", {.tile_sum = true}, true}, {"pick", {}}};

class Frames {
public:
    Frames(const Device& device, const Scene& scene, const Options& options, const Method& method)
        : device_(with(device, method)),
          scene_(scene),
          renderer_(device_, scene,
                    {.width = options.size.first,
                     .height = options.size.second,
                     .spp = 1,
                     .max_depth = 1,
                     .approximate = method.approximate}) {
        renderer_.settle();
    }

    void next() {
        for (Light& light : scene_.lights) light.position += 1e-3f;
        const auto begin = std::chrono::steady_clock::now();
        renderer_.update(scene_, {.lights = true});
        const auto updated = std::chrono::steady_clock::now();
        device_.profiler().reset();
        (void)renderer_.render();
        const auto end = std::chrono::steady_clock::now();
        double kernels = 0;
        for (const auto& [name, summary] : device_.profiler().summary()) {
            times_[name].push_back(summary.milliseconds);
            kernels += summary.milliseconds;
        }
        times_["all of the device"].push_back(kernels);
        times_["change of the lights"].push_back(1e3 * std::chrono::duration<double>(updated - begin).count());
        times_["frame, wall clock"].push_back(1e3 * std::chrono::duration<double>(end - updated).count());
    }

    [[nodiscard]] const std::map<std::string, std::vector<double>>& times() const { return times_; }

private:
    static Device with(Device device, const Method& method) {
        for (const char* limit : {"MOST_PER_TILE", "MOST_PER_BLOCK"})
            if (method.all_lights) device.set_tuning("deferred/list_lights", limit, 0);
        return device;
    }

    Device device_;
    Scene scene_;
    Renderer renderer_;
    std::map<std::string, std::vector<double>> times_;
};

/// Sums of the values that images have in one channel of a pixel.
struct Moments {
    double sum = 0, squares = 0;
};

void print_noise(const Device& device, const Scene& scene, const Options& options) {
    RenderConfig config{
        .width = options.size.first, .height = options.size.second, .spp = options.spp, .max_depth = options.depth};
    if (options.tree) config.effects.remove = {Effect::light_lists};
    Renderer renderer(device, scene, config);
    std::vector<Moments> moments;
    std::vector<double> seconds;
    for (int round = 0; round < options.rounds; ++round) {
        renderer.restart(std::uint32_t(round) + 1);
        const auto begin = std::chrono::steady_clock::now();
        renderer.render();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        const auto image = renderer.radiance();
        moments.resize(3 * image.size());
        for (std::size_t i = 0; i < moments.size(); ++i) {
            const double value = image[i / 3][int(i % 3)];
            moments[i].sum += value, moments[i].squares += value * value;
        }
    }
    const double rounds = options.rounds;
    double mean = 0, variance = 0;
    for (const Moments& m : moments) {
        mean += m.sum / rounds;
        variance += (m.squares - m.sum * m.sum / rounds) / (rounds - 1);
    }
    const auto values = double(moments.size());
    const double noise = 100 * std::sqrt(variance / values) / (mean / values);
    std::printf("noise: %.1f %% with %u spp, %.1f %% with 1; mean radiance %.6g; %.3f s\n", noise, options.spp,
                std::sqrt(double(options.spp)) * noise, mean / values, median_of(seconds));
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times of frames under many moving lights");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--scene", options.scene);
    app.add_option("--size", options.size, "pixels: width and height [640 360]");
    app.add_option("--lights", options.lights);
    app.add_option("--range", options.range, "of the lights [2.5]");
    app.add_flag("--equal", options.equal, "shorten the range so that a tile has as many lights as with 1000");
    app.add_option("--camera", options.camera, "its position")->expected(3);
    app.add_option("--target", options.target, "where it looks")->expected(3);
    app.add_option("--frames", options.frames, "which to time [tile-sum all-lights pick]")->expected(1, 3);
    app.add_option("--rounds", options.rounds);
    app.add_flag("--noise", options.noise, "print the noise of `pick` only, from --rounds images");
    app.add_flag("--tree", options.tree, "pick by the light tree, not from lists")->needs("--noise");
    app.add_option("--spp", options.spp, "samples per pixel [16]")->needs("--noise");
    app.add_option("--depth", options.depth, "surfaces per path [1]")->needs("--noise");
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    Warnings warnings;
    Scene scene = load_scene(options.scene, warnings);
    scene.camera = camera_of(scene, float(options.size.first) / float(options.size.second));
    const auto vector = [](const std::vector<float>& v) { return glm::vec3(v[0], v[1], v[2]); };
    if (!options.camera.empty()) scene.camera->position = vector(options.camera);
    if (!options.target.empty()) scene.camera->target = vector(options.target);
    const float shorter = options.equal ? std::cbrt(1000.f / float(options.lights)) : 1.f;
    scene.sky = {}, scene.environment = {};
    scene.lights = lights_within(bounds_of(scene), options.lights, options.range * shorter);
    if (options.noise) {
        print_noise(Device::open(options.device), scene, options);
        return 0;
    }
    std::vector<Frames> all;
    std::vector<const char*> names;
    for (const Method& method : methods) {
        if (std::find(options.frames.begin(), options.frames.end(), method.name) == options.frames.end()) continue;
        all.emplace_back(Device::open(options.device), scene, options, method);
        names.push_back(method.name);
    }
    for (int i = 0; i < options.rounds + 2; ++i)
        for (Frames& frames : all) frames.next();
    measure::Csv csv(options.csv, Device::open(options.device), "scene,width,height,lights,method,kernel,milliseconds");
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const auto& [name, times] : all[i].times()) {
            const double milliseconds = median_of(times);
            std::printf("%-11s %-22s %9.3f ms\n", names[i], name.c_str(), milliseconds);
            csv.row(options.scene, options.size.first, options.size.second, options.lights, names[i], name,
                    milliseconds);
        }
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_deferred: error: %s\n", error.what());
    return 1;
}
