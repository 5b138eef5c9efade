// The speed of a device: measured here, stored in the tuning table.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "claray/plan/target.hpp"
#include "host/compute/device_state.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* table_name = "plan/model";
constexpr unsigned side = 128;  // of the images that are rendered
constexpr double least_seconds = 0.15;
constexpr int rounds = 5;

/// A figure of the model and its row: counts are whole there.
struct Figure {
    const char* parameter;
    double scale;
    double& (*of)(DeviceModel& model);
};
constexpr Figure figures[] = {
#define CLARAY_ROW(name, NAME, note, codes, splits) \
    {#NAME "_PICOSECONDS_PER_TRIANGLE", 1e3, [](DeviceModel& m) -> double& { return m.name.build_nanoseconds; }},
    CLARAY_PLANNED_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
#define CLARAY_ROW(name, NAME, note, codes, splits) \
    {#NAME "_SAMPLES_PER_SECOND", 1, [](DeviceModel& m) -> double& { return m.name.samples_per_second; }},
        CLARAY_PLANNED_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
            {"INDEPENDENT_COST_PERMILLE", 1e3, [](DeviceModel& m) -> double& { return m.independent_cost; }},
};

/// The builder's part of a model, const or not; that of `fast` for a builder that the planner does not choose.
template <class Model>
auto& preset_of(Model& model, Builder builder) {
    switch (builder) {
#define CLARAY_ROW(name, NAME, note, codes, splits) \
    case Builder::name: return model.name;
        CLARAY_PLANNED_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
        default: return model.fast;
    }
}

/// On a CPU device the threads' time shared out among its units, which other programs don't lengthen.
double render_seconds(const Device& device, Renderer& renderer) {
    const std::clock_t begin = std::clock();
    const double seconds = renderer.render().seconds;
    if (device.info().type != DeviceType::cpu) return seconds;
    return double(std::clock() - begin) / CLOCKS_PER_SEC / std::max(1u, device.info().compute_units);
}

double seconds_of(const std::function<void()>& work) {
    const Clock::time_point begin = Clock::now();
    work();
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The second time, when all is compiled.
double seconds_to_build(const Device& device, const Scene& scene, Builder builder) {
    double least = INFINITY;
    Bvh bvh = Bvh::build(device, scene.meshes, {.builder = builder});
    for (int i = 0; i < 2; ++i)
        least = std::min(least, seconds_of([&] {
                             bvh.rebuild();
                             device.finish();
                         }));
    return least;
}

/// Renders by turns, since machines are slower at times, for all trees alike.
void measure_speeds(const Device& device, const Scene& scene, DeviceModel& model) {
    RenderConfig config{.width = side, .height = side, .spp = 1};
    const auto seconds_at = [&](unsigned spp) {
        config.spp = spp;
        Renderer renderer(device, scene, config);
        (void)renderer.render();  // compiles
        renderer.restart(1);
        return renderer.render().seconds;
    };
    const double seconds = seconds_at(4);
    config.spp = unsigned(std::clamp(4 * least_seconds / std::max(seconds, 1e-5), 1.0, 65536.0));
    std::vector<Renderer> renderers;
    for (const Builder builder : planned_builders) {
        config.bvh.builder = builder;
        renderers.emplace_back(device, scene, config);
        (void)renderers.back().render();
    }
    std::vector<double> least(renderers.size(), INFINITY);
    for (std::uint32_t round = 1; round <= rounds; ++round)
        for (std::size_t i = 0; i < renderers.size(); ++i) {
            renderers[i].restart(round);
            least[i] = std::min(least[i], render_seconds(device, renderers[i]));
        }
    const double samples = double(side) * side * config.spp;
    for (std::size_t i = 0; i < least.size(); ++i)
        preset_of(model, planned_builders[i]).samples_per_second = samples / least[i];
}

/// Error squared times seconds: what an error costs, since it falls with the root of the time.
double cost_of_error(const Device& device, const Scene& scene, Sampler sampler) {
    RenderConfig config{.width = side, .height = side, .spp = 32, .error = 1e-9, .sampler = sampler};
    Renderer renderer(device, scene, config);
    double squares = 0, seconds = INFINITY;
    for (std::uint32_t round = 0; round < 3; ++round) {
        renderer.restart(round);
        seconds = std::min(seconds, render_seconds(device, renderer));
        const double error = renderer.render().error;
        squares += error * error;
    }
    return squares * seconds;
}

}  // namespace

const DeviceModel::Preset& DeviceModel::of(Builder builder) const { return preset_of(*this, builder); }

DeviceModel stored_model(const Device& device) {
    DeviceModel model;
    const auto& tuning = state_of(device).tuning;
    for (const Figure& figure : figures) {
        const auto row = tuning.find(std::string(table_name) + " " + figure.parameter);
        if (row == tuning.end() || row->second == 0) return {};
        figure.of(model) = row->second / figure.scale;
    }
    return model;
}

std::vector<ModelRow> rows_of(const DeviceModel& model) {
    DeviceModel copy = model;
    std::vector<ModelRow> rows;
    for (const Figure& figure : figures) {
        const double value = std::round(figure.of(copy) * figure.scale);
        rows.push_back({table_name, figure.parameter, unsigned(std::clamp(value, 1.0, 4294967295.0))});
    }
    return rows;
}

DeviceModel measure_model(const Device& device, std::size_t triangles, const MeasuringProgress& progress) {
    const Scene scene = *builtin_scene("terrain:" + std::to_string(triangles));
    DeviceModel model;
    const double nanoseconds = 1e9 / double(triangles);
    const auto goes_on = [&](const std::string& what) { return !progress || progress(what); };
    for (const Builder builder : planned_builders) {
        if (!goes_on(std::string("the ") + traits_of(builder).name + " builder")) return {};
        preset_of(model, builder).build_nanoseconds = nanoseconds * seconds_to_build(device, scene, builder);
    }
    if (!goes_on("samples per second with these trees")) return {};
    measure_speeds(device, scene, model);
    if (!goes_on("the error of both samplers")) return {};
    model.independent_cost =
        cost_of_error(device, scene, Sampler::independent) / cost_of_error(device, scene, Sampler::sobol);
    return model;
}

}  // namespace claray
