// Noise at equal time: one light against many lights of the same flux, in the Cornell box:
//   bench_lights [--device D] [--size N] [--spp N] [--depth N] [--rounds N] [--only TEXT] [--no-power]
//               [--csv FILE]
// The noise of an image falls with the square root of time, so what is compared is noise * sqrt(seconds). Seconds are
// of the process's CPU time where the device is a CPU (others may use the machine), of its kernels where it is not.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv, only;
    bool no_power = false;
    unsigned size = 64, spp = 64, depth = 8, rounds = 3;
    unsigned points = 1000, triangles = 100'000;
};

struct Arrangement {
    const char* name;
    Scene scene;
    std::size_t of = 0;     // with which of the list it is compared
    bool by_power = false;  // without the tree
    bool wanted = true;
    double noise = 0, seconds = 0;
};

/// From within the box down to its floor: lights in view would make up all of the noise.
const Camera camera{{0.278f, 0.28f, 0.04f}, {0.278f, 0.f, 0.34f}, {0.f, 1.f, 0.f}, 55.f};

void add_mesh(Scene& scene, const Mesh& mesh, const glm::vec3& emission) {
    Material material;
    material.albedo = glm::vec3(0.f), material.emission = emission;
    scene.meshes.push_back(mesh);
    scene.meshes.back().materials.assign(mesh.triangles.size(), std::uint32_t(scene.materials.size()));
    scene.materials.push_back(material);
}

/// The Cornell box and what its lamp emits, in other shapes.
class Arranger {
public:
    explicit Arranger(const Options& options) : options_(options) {
        box_ = *builtin_scene("cornell");
        const auto lamp =
            std::find_if(box_.meshes.begin(), box_.meshes.end(), [&](const Mesh& m) { return m.name == "lamp"; });
        lamp_ = *lamp;
        radiance_ = box_.materials[lamp_.materials[0]].emission;
        box_.meshes.erase(lamp);
        for (int k = 0; k < 4; ++k) corners_[k] = lamp_.positions[std::size_t(k)];
        across_ = corners_[1] - corners_[0], along_ = corners_[3] - corners_[0];
        area_ = glm::length(glm::cross(across_, along_));
    }
    std::vector<Arrangement> all();

private:
    glm::vec3 flux() const { return 2.f * pi * area_ * radiance_; }  // from both sides
    float unit() { return std::uniform_real_distribution<float>(0.f, 1.f)(random_); }
    glm::vec3 on_lamp() { return corners_[0] + unit() * across_ + unit() * along_; }
    glm::vec3 in_room() { return {0.05f + 0.45f * unit(), 0.3f + 0.2f * unit(), 0.05f + 0.45f * unit()}; }
    /// With the ceiling closed, so that the place of the lamp is like what is round it.
    Scene dark() const {
        Scene scene = box_;
        scene.meshes.push_back(lamp_);
        for (std::uint32_t& material : scene.meshes.back().materials) material = box_.meshes[0].materials[0];
        return scene;
    }
    Scene with_points(const std::vector<glm::vec3>& places) const {
        Scene scene = dark();
        for (const glm::vec3& place : places)
            scene.lights.push_back(point_light(place, flux() / (4 * pi * float(places.size()))));
        return scene;
    }
    Mesh panel() const;
    Mesh cloud();
    /// What is not one light is compared with the one before it, picked by the tree and by power alone.
    void add(const char* name, Scene scene, bool one) {
        scene.camera = camera;
        if (one) of_ = list_.size();
        list_.push_back({name, scene, of_});
        if (!one) list_.push_back({name, scene, of_, true});
    }

    static constexpr float pi = 3.14159265f;
    const Options& options_;
    Scene box_;  // with a hole where the lamp was
    Mesh lamp_;
    glm::vec3 radiance_, corners_[4], across_, along_;
    float area_;
    std::mt19937 random_{1};
    std::vector<Arrangement> list_;
    std::size_t of_ = 0;
};

/// The lamp, in many triangles.
Mesh Arranger::panel() const {
    const auto side = unsigned(std::lround(std::sqrt(options_.triangles / 2)));
    Mesh mesh;
    for (unsigned y = 0; y <= side; ++y)
        for (unsigned x = 0; x <= side; ++x)
            mesh.positions.push_back(corners_[0] + float(x) / float(side) * across_ + float(y) / float(side) * along_);
    for (unsigned y = 0; y < side; ++y)
        for (unsigned x = 0; x < side; ++x) {
            const unsigned at = y * (side + 1) + x;
            mesh.triangles.emplace_back(at, at + 1, at + side + 2);
            mesh.triangles.emplace_back(at, at + side + 2, at + side + 1);
        }
    return mesh;
}

Mesh Arranger::cloud() {
    Mesh mesh;
    for (unsigned i = 0; i < options_.triangles; ++i) {
        const glm::vec3 at = in_room();
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(at + 0.0004f * (glm::vec3(unit(), unit(), unit()) - 0.5f));
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

double area_of(const Mesh& mesh) {
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 a = mesh.positions[t.x];
        area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
    }
    return area;
}

std::vector<Arrangement> Arranger::all() {
    const glm::vec3 below(0.f, -0.02f, 0.f), center = corners_[0] + 0.5f * (across_ + along_) + below;
    const glm::vec3 middle(0.275f, 0.4f, 0.275f);
    const auto places = [&](auto&& place) {
        std::vector<glm::vec3> list(options_.points);
        std::generate(list.begin(), list.end(), place);
        return list;
    };
    add("one point below the ceiling", with_points({center}), true);
    add("many points below the ceiling", with_points(places([&] { return on_lamp() + below; })), false);
    add("one point in the room", with_points({middle}), true);
    add("many points in the room", with_points(places([&] { return in_room(); })), false);

    add("the lamp, two triangles", *builtin_scene("cornell"), true);
    Scene scene = box_;
    add_mesh(scene, panel(), radiance_);
    add("the lamp, many triangles", scene, false);
    // Triangles take time to trace, too, lamps or not: so once more among as many black ones.
    scene.materials.back().emission = glm::vec3(0.f);
    for (glm::vec3& p : scene.meshes.back().positions) p.y += 0.001f;
    add_mesh(scene, lamp_, radiance_);
    add("the lamp, below a black panel", scene, true);
    scene = box_;
    add_mesh(scene, panel(), radiance_);
    add("the lamp, many triangles", scene, false);

    const Mesh all = cloud();
    const double area = area_of(all);
    const auto among = [&](const Mesh& mesh, const glm::vec3& emission, const glm::vec3& others) {
        scene = dark();
        add_mesh(scene, mesh, emission);
        if (&mesh != &all) add_mesh(scene, all, others);
        return scene;
    };
    const glm::vec3 bright = flux() / float(2 * pi * area);
    Mesh one;  // of the area of all
    const auto side = float(std::sqrt(area * 4 / std::sqrt(3.0)));
    one.positions = {middle, middle + glm::vec3(side, 0, 0), middle + glm::vec3(0.5f * side, 0, 0.8660254f * side)};
    one.triangles = {{0, 1, 2}};
    add("one triangle among black ones", among(one, bright, glm::vec3(0.f)), true);
    add("many triangles in the room", among(all, bright, bright), false);
    return std::move(list_);
}

void measure(const Device& device, const Options& options, Arrangement& arrangement, unsigned round) {
    RenderConfig config{.width = options.size, .height = options.size, .spp = options.spp, .max_depth = options.depth};
    config.seed = round;
    if (arrangement.by_power) config.effects.remove = {Effect::light_lists, Effect::many_lights};
    Renderer renderer(device, arrangement.scene, config);
    const auto kernels = [&] {
        double total = 0;
        for (const auto& [name, summary] : device.profiler().summary()) total += summary.milliseconds;
        return total * 1e-3;
    };
    device.finish();
    const bool cpu = device.info().type == DeviceType::cpu;
    const double before = cpu ? double(std::clock()) / CLOCKS_PER_SEC : kernels();
    const double noise = renderer.render().noise;
    const double seconds = (cpu ? double(std::clock()) / CLOCKS_PER_SEC : kernels()) - before;
    arrangement.noise += noise * noise / options.rounds;
    if (arrangement.seconds == 0 || seconds < arrangement.seconds) arrangement.seconds = seconds;
}

/// Leaves those whose name has the text in it, and what these are compared with.
void keep(std::vector<Arrangement>& list, const Options& options) {
    for (Arrangement& a : list) {
        const auto named = [&](const Arrangement& other) {
            return std::string(other.name).find(options.only) != std::string::npos;
        };
        a.wanted = named(a) && !(a.by_power && options.no_power);
        if (a.wanted) list[a.of].wanted = true;
    }
}

void run(const Options& options) {
    const Device device = Device::open(options.device);
    std::printf("%s, %ux%u, %u spp, depth %u\n", device.info().name.c_str(), options.size, options.size, options.spp,
                options.depth);
    std::vector<Arrangement> list = Arranger(options).all();
    keep(list, options);
    Options warm = options;
    warm.spp = 1;
    for (Arrangement& arrangement : list) {
        if (!arrangement.wanted) continue;
        Arrangement copy = arrangement;
        measure(device, warm, copy, 0);  // compiles the kernels
    }
    for (unsigned round = 0; round < options.rounds; ++round)
        for (Arrangement& arrangement : list)
            if (arrangement.wanted) measure(device, options, arrangement, round);
    measure::Csv csv(options.csv, device,
                     "lights,picked_by,size,spp,depth,noise,seconds,noise_at_equal_time,of_one_light");
    std::printf("%-32s %-8s %9s %9s %9s\n", "lights", "picked", "noise", "seconds", "of one");
    const auto equal = [](const Arrangement& a) { return std::sqrt(a.noise * a.seconds); };
    for (const Arrangement& a : list) {
        if (!a.wanted) continue;
        std::printf("%-32s %-8s %7.3f %% %9.3f %9.2f\n", a.name, a.by_power ? "by power" : "", 100 * std::sqrt(a.noise),
                    a.seconds, equal(a) / equal(list[a.of]));
        csv.row('"' + std::string(a.name) + '"', a.by_power ? "power" : "claray", options.size, options.spp,
                options.depth, std::sqrt(a.noise), a.seconds, equal(a), equal(a) / equal(list[a.of]));
    }
    csv.write();
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Noise at equal time of many lights against one");
    Options options;
    app.add_option("--device", options.device, "cpu, gpu, an index or part of a name");
    app.add_option("--size", options.size, "Pixels a side [64]");
    app.add_option("--spp", options.spp, "Samples per pixel [64]");
    app.add_option("--depth", options.depth, "Surfaces per path, at most [8]");
    app.add_option("--rounds", options.rounds, "Renders of each [3]");
    app.add_option("--points", options.points, "Point lights [1000]");
    app.add_option("--triangles", options.triangles, "Emissive triangles [100000]");
    app.add_option("--only", options.only,
                   "Only arrangements whose name has this in it, and what they are compared with");
    app.add_flag("--no-power", options.no_power, "Not without the tree");
    app.add_option("--csv", options.csv, "Write the results to FILE");
    CLI11_PARSE(app, argc, argv);
    run(options);
    return 0;
} catch (const Error& error) {
    std::fprintf(stderr, "bench_lights: %s\n", error.what());
    return int(error.kind());
}
