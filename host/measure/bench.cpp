#include "host/measure/bench.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

#include "host/measure/names.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {
namespace {

void check_same_hits(const std::string& scene, std::vector<DeviceRays>& kinds, const std::vector<Bvh>& bvhs) {
    for (DeviceRays& kind : kinds) {
        std::string first;
        for (std::size_t i = 0; i < bvhs.size(); ++i) {
            kind.trace(bvhs[i]);
            std::string results = kind.results();
            if (i == 0)
                first = std::move(results);
            else if (results != first)
                throw Error(ErrorKind::device,
                            scene + ": two presets disagree about the hits of " + kind.name + " rays on " +
                                bvhs[i].device().info().name,
                            "run the tests on this device, and report this error");
        }
    }
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

}  // namespace

double PresetResult::Kind::mrays_per_second() const {
    const double ms = timing.milliseconds();
    return ms > 0 ? double(rays) * 1e-3 / ms : 0;
}

double PresetResult::mtriangles_per_second() const {
    const double ms = build.milliseconds();
    return ms > 0 ? double(statistics.triangles) * 1e-3 / ms : 0;
}

SceneResult run_bench(const Device& device, const std::string& scene, const BenchOptions& options) {
    const std::vector<Mesh> meshes = load_meshes(scene);
    std::vector<DeviceRays> kinds = upload_rays(device, scene, meshes, options.width, options.height);
    std::vector<Bvh> bvhs;
    for (const Builder preset : options.presets)
        bvhs.push_back(Bvh::build(device, meshes, {.builder = preset, .layout = options.layout}));
    check_same_hits(scene, kinds, bvhs);

    // Positions do not change, so that refitting does not change the tree.
    std::vector<std::function<void()>> tasks;
    for (Bvh& bvh : bvhs) {
        tasks.emplace_back([&bvh] { bvh.rebuild(); });
        tasks.emplace_back([&bvh] { bvh.refit(); });
        for (DeviceRays& kind : kinds) tasks.emplace_back([&bvh, &kind] { kind.trace(bvh); });
    }
    const std::vector<Timing> timings = measure_rounds(device, options.repeat, tasks);

    SceneResult result{scene, bvhs.empty() ? 0 : bvhs[0].triangle_count(), {}};
    for (std::size_t i = 0; i < bvhs.size(); ++i) {
        const Timing* timing = &timings[i * (kinds.size() + 2)];
        PresetResult preset;
        preset.preset = name_of(builders, options.presets[i]);
        preset.layout = name_of(layouts, bvhs[i].layout());
        preset.build = timing[0];
        preset.refit = timing[1];
        preset.statistics = bvhs[i].statistics();
        for (std::size_t k = 0; k < kinds.size(); ++k)
            preset.kinds.push_back({kinds[k].name, kinds[k].rays.size(), timing[2 + k]});
        result.presets.push_back(std::move(preset));
    }
    return result;
}

double build_and_trace(const PresetResult& preset, std::size_t kind, double rays) {
    const PresetResult::Kind& of = preset.kinds.at(kind);
    return preset.build.span() + (of.rays > 0 ? rays * of.timing.milliseconds() / double(of.rays) : 0);
}

// Times are linear in the number of rays: the next winner is the line that first crosses the current one.
std::vector<Winner> quickest_presets(const SceneResult& scene, std::size_t kind) {
    const auto build = [&](std::size_t i) { return build_and_trace(scene.presets[i], kind, 0); };
    const auto slope = [&](std::size_t i) { return build_and_trace(scene.presets[i], kind, 1) - build(i); };
    std::vector<Winner> winners;
    if (scene.presets.empty()) return winners;
    std::size_t now = 0;
    for (std::size_t i = 1; i < scene.presets.size(); ++i)
        if (std::pair(build(i), slope(i)) < std::pair(build(now), slope(now))) now = i;
    winners.push_back({scene.presets[now].preset, 0});
    for (;;) {
        double nearest = std::numeric_limits<double>::infinity();
        std::size_t next = now;
        for (std::size_t i = 0; i < scene.presets.size(); ++i) {
            if (!(slope(i) < slope(now))) continue;
            const double crossing = (build(i) - build(now)) / (slope(now) - slope(i));
            if (crossing < nearest) nearest = crossing, next = i;
        }
        if (next == now) return winners;
        now = next;
        winners.push_back({scene.presets[now].preset, nearest});
    }
}

std::string bench_csv_header() {
    return "device,driver,scene,triangles,preset,layout,what,count,milliseconds,spread,millions_per_second,sah_cost,"
           "bytes\n";
}

std::string bench_csv(const DeviceInfo& device, const SceneResult& scene) {
    std::ostringstream text;
    for (const PresetResult& preset : scene.presets) {
        const auto row = [&](const std::string& what, double count, double ms, double spread) {
            text << quoted(device.name) << ',' << quoted(device.driver) << ',' << quoted(scene.scene) << ','
                 << scene.triangles << ',' << preset.preset << ',' << preset.layout << ',' << what << ',' << count
                 << ',' << ms << ',' << spread << ',' << (ms > 0 ? count * 1e-3 / ms : 0) << ','
                 << preset.statistics.sah_cost << ',' << preset.statistics.bytes << '\n';
        };
        const double triangles = preset.statistics.triangles;
        row("build", triangles, preset.build.milliseconds(), preset.build.spread());
        row("build span", triangles, preset.build.span(), relative_spread(preset.build.spans));
        for (const auto& [command, ms] : preset.build.commands) row("build: " + command, triangles, ms, 0);
        row("refit", triangles, preset.refit.milliseconds(), preset.refit.spread());
        for (const PresetResult::Kind& kind : preset.kinds)
            row(kind.name, double(kind.rays), kind.timing.milliseconds(), kind.timing.spread());
        for (std::size_t kind = 0; kind < preset.kinds.size(); ++kind)
            for (const double rays : ray_counts)
                row("build span + " + preset.kinds[kind].name, rays, build_and_trace(preset, kind, rays), 0);
    }
    return text.str();
}

}  // namespace claray::measure
