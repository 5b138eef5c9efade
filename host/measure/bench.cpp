#include "host/measure/bench.hpp"

#include <algorithm>
#include <atomic>
#include <future>
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

SceneBench::SceneBench(const Device& device, const std::string& scene, const BenchOptions& options)
    : device_(device), scene_(scene), options_(options) {
    const std::vector<Mesh> meshes = load_meshes(scene);
    kinds_ = upload_rays(device, scene, meshes, options.width, options.height);
    for (const Builder preset : options.presets)
        bvhs_.push_back(Bvh::build(device, meshes, {.builder = preset, .layout = options.layout}));
    check_same_hits(scene, kinds_, bvhs_);
}

SceneResult SceneBench::run() {
    std::vector<std::function<void()>> tasks;
    for (Bvh& bvh : bvhs_) {
        tasks.emplace_back([&bvh] { bvh.refit(); });
        tasks.emplace_back(
            [&bvh] { bvh.rebuild(); });  // a refit grows the boxes of triangles that the builder has split
        for (DeviceRays& kind : kinds_) tasks.emplace_back([&bvh, &kind] { kind.trace(bvh); });
    }
    const std::vector<Timing> timings = measure_rounds(device_, options_.repeat, tasks);

    SceneResult result{scene_, bvhs_.empty() ? 0 : bvhs_[0].triangle_count(), {}};
    for (std::size_t i = 0; i < bvhs_.size(); ++i) {
        const Timing* timing = &timings[i * (kinds_.size() + 2)];
        PresetResult preset;
        preset.preset = name_of(builders, options_.presets[i]);
        preset.layout = name_of(layouts, bvhs_[i].layout());
        preset.refit = timing[0];
        preset.build = timing[1];
        preset.statistics = bvhs_[i].statistics();
        for (std::size_t k = 0; k < kinds_.size(); ++k)
            preset.kinds.push_back({kinds_[k].name, kinds_[k].rays.size(), timing[2 + k]});
        result.presets.push_back(std::move(preset));
    }
    return result;
}

std::vector<SceneResult> run_at_once(std::vector<SceneBench>& benches) {
    std::vector<SceneResult> results(benches.size());
    std::atomic<std::size_t> busy{benches.size()};
    const auto work = [&](std::size_t i) {
        try {
            results[i] = benches[i].run();
        } catch (...) {
            --busy;
            throw;
        }
        for (--busy; busy > 0;) (void)benches[i].run();
    };
    std::vector<std::future<void>> runs;
    for (std::size_t i = 0; i < benches.size(); ++i) runs.push_back(std::async(std::launch::async, work, i));
    for (std::future<void>& run : runs) run.get();
    return results;
}

std::vector<JointResult> joint_results(const std::vector<SceneResult>& alone, const std::vector<SceneResult>& at_once) {
    const auto sum = [](const std::vector<SceneResult>& devices, std::size_t preset, std::size_t kind) {
        double rate = 0;
        for (const SceneResult& device : devices) rate += device.presets[preset].kinds[kind].mrays_per_second();
        return rate;
    };
    std::vector<JointResult> results;
    for (std::size_t p = 0; p < at_once.at(0).presets.size(); ++p) {
        const PresetResult& first = at_once[0].presets[p];
        JointResult result{first.preset, {}};
        for (std::size_t k = 0; k < first.kinds.size(); ++k) {
            const double together = sum(at_once, p, k), apart = sum(alone, p, k);
            result.kinds.push_back({first.kinds[k].name, together, apart > 0 ? together / apart : 0});
        }
        results.push_back(std::move(result));
    }
    return results;
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
