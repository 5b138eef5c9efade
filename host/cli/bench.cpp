// claray bench: how fast a device builds trees and traces rays.
#include "host/measure/bench.hpp"

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/io.hpp"
#include "host/base/file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/table.hpp"
#include "host/io/scene_readers.hpp"
#include "host/measure/names.hpp"
#include "host/measure/rays.hpp"

namespace claray::cli {
namespace {

struct BenchOptions {
    measure::BenchOptions bench;
    std::vector<std::string> devices;
    std::filesystem::path csv;
    bool json = false, stages = false;
};

std::string short_count(double count) {
    static constexpr std::pair<double, const char*> units[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}};
    for (const auto& [unit, name] : units)
        if (count >= unit) return fixed(count / unit, count / unit < 10 ? 1 : 0) + " " + name;
    return fixed(count, 0);
}

void print_results(const measure::SceneResult& scene) {
    Row head = {"preset", "layout", "build ms", "spread", "Mtri/s", "span ms", "refit ms", "SAH", "MB"};
    for (const auto& kind : scene.presets.at(0).kinds) head.push_back(kind.name);
    std::vector<Row> rows = {head};
    for (const measure::PresetResult& p : scene.presets) {
        Row row = {p.preset,
                   p.layout,
                   fixed(p.build.milliseconds(), 3),
                   fixed(100 * p.build.spread(), 0) + " %",
                   fixed(p.mtriangles_per_second(), 1),
                   fixed(p.build.span(), 3),
                   fixed(p.refit.milliseconds(), 3),
                   fixed(p.statistics.sah_cost, 1),
                   fixed(double(p.statistics.bytes) * 1e-6, 1)};
        for (const auto& kind : p.kinds) row.push_back(fixed(kind.mrays_per_second(), 2));
        rows.push_back(std::move(row));
    }
    std::printf("%s: %zu triangles; rays in Mrays/s\n", scene.scene.c_str(), scene.triangles);
    print_table(rows, 2);
}

void print_stages(const measure::SceneResult& scene) {
    std::vector<Row> rows = {{"build ms"}};
    std::map<std::string, Row> stages;
    for (std::size_t i = 0; i < scene.presets.size(); ++i) {
        rows[0].push_back(scene.presets[i].preset);
        for (const auto& [stage, ms] : scene.presets[i].build.commands) {
            Row& row = stages.try_emplace(stage, scene.presets.size() + 1).first->second;
            row[0] = stage;
            row[i + 1] = fixed(ms, 3);
        }
    }
    for (const auto& [stage, row] : stages) rows.push_back(row);
    print_table(rows, 1);
}

/// Milliseconds to build and trace, and the number of rays from which on each preset is the fastest.
void print_together(const measure::SceneResult& scene) {
    Row head = {"build + trace, ms", "preset"};
    for (const double rays : measure::ray_counts) head.push_back(short_count(rays) + " rays");
    std::vector<Row> rows = {head};
    std::string winners;
    for (std::size_t kind = 0; kind < scene.presets.at(0).kinds.size(); ++kind) {
        const std::string& name = scene.presets[0].kinds[kind].name;
        for (const measure::PresetResult& preset : scene.presets) {
            Row row = {name, preset.preset};
            for (const double rays : measure::ray_counts)
                row.push_back(fixed(measure::build_and_trace(preset, kind, rays), 2));
            rows.push_back(std::move(row));
        }
        winners += (winners.empty() ? "" : "; ") + name + ":";
        const char* separator = " ";
        for (const measure::Winner& winner : measure::quickest_presets(scene, kind)) {
            winners += separator + winner.preset;
            if (winner.from_rays > 0) winners += " from " + short_count(winner.from_rays) + " rays on";
            separator = ", ";
        }
    }
    print_table(rows, 2);
    std::printf("quickest together: %s\n", winners.c_str());
}

void print_joint(const std::string& scene, std::size_t devices, const std::vector<measure::JointResult>& results) {
    Row head = {"preset"};
    for (const auto& kind : results.at(0).kinds) head.push_back(kind.name);
    std::vector<Row> rows = {head};
    for (const measure::JointResult& result : results) {
        Row row = {result.preset};
        for (const auto& kind : result.kinds)
            row.push_back(fixed(kind.mrays_per_second, 2) + " (" + fixed(kind.share, 2) + ")");
        rows.push_back(std::move(row));
    }
    std::printf("\n%s: %zu devices at the same time; Mrays/s of all, and the share of the sum of each alone\n",
                scene.c_str(), devices);
    print_table(rows, 1);
}

nlohmann::ordered_json as_json(const std::string& scene, const std::vector<measure::JointResult>& results) {
    nlohmann::ordered_json presets = nlohmann::ordered_json::array();
    for (const measure::JointResult& result : results) {
        nlohmann::ordered_json rays;
        for (const auto& kind : result.kinds)
            rays[kind.name] = {{"mrays_per_second", kind.mrays_per_second}, {"share_of_sum", kind.share}};
        presets.push_back({{"preset", result.preset}, {"rays", rays}});
    }
    return {{"scene", scene}, {"presets", presets}};
}

nlohmann::ordered_json as_json(const measure::SceneResult& scene) {
    nlohmann::ordered_json presets = nlohmann::ordered_json::array();
    for (const measure::PresetResult& p : scene.presets) {
        nlohmann::ordered_json rays, together;
        for (std::size_t kind = 0; kind < p.kinds.size(); ++kind) {
            rays[p.kinds[kind].name] = {{"rays", p.kinds[kind].rays},
                                        {"milliseconds", p.kinds[kind].timing.milliseconds()},
                                        {"spread", p.kinds[kind].timing.spread()},
                                        {"mrays_per_second", p.kinds[kind].mrays_per_second()}};
            for (const double count : measure::ray_counts)
                together[p.kinds[kind].name].push_back(
                    {{"rays", count}, {"milliseconds", measure::build_and_trace(p, kind, count)}});
        }
        presets.push_back({{"preset", p.preset},
                           {"layout", p.layout},
                           {"build",
                            {{"milliseconds", p.build.milliseconds()},
                             {"span", p.build.span()},
                             {"spread", p.build.spread()},
                             {"mtriangles_per_second", p.mtriangles_per_second()},
                             {"stages", p.build.commands}}},
                           {"refit", {{"milliseconds", p.refit.milliseconds()}}},
                           {"triangles", p.statistics.triangles},
                           {"culled", p.statistics.culled},
                           {"height", p.statistics.height},
                           {"sah_cost", p.statistics.sah_cost},
                           {"bytes", p.statistics.bytes},
                           {"rays", rays},
                           {"build_and_trace", together}});
    }
    nlohmann::ordered_json quickest;
    for (std::size_t kind = 0; kind < scene.presets.at(0).kinds.size(); ++kind)
        for (const measure::Winner& winner : measure::quickest_presets(scene, kind))
            quickest[scene.presets[0].kinds[kind].name].push_back(
                {{"preset", winner.preset}, {"from_rays", winner.from_rays}});
    return {{"scene", scene.scene}, {"triangles", scene.triangles}, {"presets", presets}, {"quickest", quickest}};
}

std::vector<Device> open_different(const std::vector<std::string>& selectors) {
    std::vector<Device> devices;
    const auto add = [&](Device device) {
        for (const Device& other : devices)
            if (other.info().index == device.info().index) return;
        devices.push_back(std::move(device));
    };
    if (selectors.empty()) add(open_device());
    for (const std::string& selector : selectors) {
        if (selector != "all") {
            add(open_device(selector));
            continue;
        }
        for (const DeviceInfo& info : list_devices()) add(open_device(std::to_string(info.index)));
    }
    return devices;
}

class BenchRun {
public:
    explicit BenchRun(const BenchOptions& options) : options_(options), devices_(open_different(options.devices)) {}

    void run() {
        for (const Device& device : devices_) run_on(device);
        if (devices_.size() > 1) run_on_all();
        if (options_.json) print_json(report_);
        if (!options_.csv.empty()) write_file(options_.csv, csv_);
    }

private:
    void run_on(const Device& device) {
        const DeviceInfo& info = device.info();
        nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
        if (!options_.json)
            std::printf("%s, driver %s; medians of %d interleaved rounds by the device's clock\n", info.name.c_str(),
                        info.driver.c_str(), options_.bench.repeat);
        for (const std::string& name : options_.bench.scenes) {
            const measure::SceneResult scene = measure::SceneBench(device, name, options_.bench).run();
            alone_[name].push_back(scene);
            csv_ += measure::bench_csv(info, scene);
            if (options_.json)
                scenes.push_back(as_json(scene));
            else
                print(scene);
        }
        report_.push_back({{"device", info.name}, {"driver", info.driver}, {"scenes", scenes}});
    }
    void print(const measure::SceneResult& scene) const {
        std::printf("\n");
        print_results(scene);
        if (options_.stages) print_stages(scene);
        print_together(scene);
        std::fflush(stdout);
    }
    void run_on_all() {
        nlohmann::ordered_json names = nlohmann::ordered_json::array(), scenes = nlohmann::ordered_json::array();
        for (const Device& device : devices_) names.push_back(device.info().name);
        for (const std::string& name : options_.bench.scenes) {
            std::vector<measure::SceneBench> benches;
            for (const Device& device : devices_) benches.emplace_back(device, name, options_.bench);
            const auto results = measure::joint_results(alone_[name], measure::run_at_once(benches));
            if (options_.json)
                scenes.push_back(as_json(name, results));
            else
                print_joint(name, devices_.size(), results);
        }
        report_.push_back({{"at_once", names}, {"scenes", scenes}});
    }

    const BenchOptions& options_;
    std::vector<Device> devices_;
    std::map<std::string, std::vector<measure::SceneResult>> alone_;  // by scene; of each device
    std::string csv_ = measure::bench_csv_header();
    nlohmann::ordered_json report_ = nlohmann::ordered_json::array();
};

void run_bench(const BenchOptions& options) {
    check_outputs({{"--csv", options.csv}});
    for (const std::string& name : options.bench.scenes) measure::check_scene_is_there(name);
    BenchRun(options).run();
}

}  // namespace

void add_bench_command(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("bench", "Measure build times and ray rates: scenes x presets x kinds of rays x devices");
    command->footer(
        "Shadow rays are any-hit queries, the others closest-hit queries. Random rays are the primary and bounce rays\n"
        "in random order. 'build ms' is the time of all commands of a build. 'span ms' also contains the pauses "
        "between\n"
        "them; build + trace uses it. Instances are copied to their places, into one tree.\n"
        "Example:\n"
        "  claray bench --scene sponza.obj --scene terrain:10000000 --size 1920x1080 --device gpu --csv gpu.csv");
    auto options = std::make_shared<BenchOptions>();
    BenchOptions& o = *options;
    o.bench.scenes = {"soup:50000", "terrain:200000", "hair:50000"};
    for (const auto& [name, builder] : measure::builders) o.bench.presets.push_back(builder);
    command->add_option("--scene,scenes", o.bench.scenes,
                        "Scene files (" + scene_extensions() +
                            "), built-in scenes, or NAME.scn with NAME.ray [soup:50000 terrain:200000 hair:50000]");
    command->add_option("--preset", o.bench.presets, "Builders to measure [all]")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->transform(choice_of(measure::builders))
        ->type_name("NAME");
    command
        ->add_option("--layout", o.bench.layout,
                     "Layout of the tree for tracing: automatic, binary or wide [automatic]")
        ->transform(choice_of(measure::layouts))
        ->type_name("NAME");
    add_size_option(*command, o.bench.width, o.bench.height, "WIDTHxHEIGHT of each of the three views [320x180]");
    command->add_option("--repeat", o.bench.repeat, "Rounds to measure [9]")->transform(whole_number(1, 1000));
    command
        ->add_option(
            "--device", o.devices,
            "cpu, gpu, an index, part of a name, all, or a list such as gpu,cpu. Of several devices each is measured "
            "alone, then all at the same time")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--csv", o.csv, "Also write a CSV file");
    command->add_flag("--stages", o.stages, "Also print the build time per stage");
    command->add_flag("--json", o.json, "Print the result as JSON");
    command->callback([&action, options] { action = [options] { run_bench(*options); }; });
}

}  // namespace claray::cli
