// claray build: builds a tree, measures its build time and quality, and saves it.
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/base/file.hpp"
#include "host/base/seconds_since.hpp"
#include "host/bvh/require_memory.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/table.hpp"
#include "host/compute/memory.hpp"
#include "host/io/scene_readers.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/names.hpp"
#include "host/measure/rays.hpp"

namespace claray::cli {
namespace {

struct BuildOptions {
    std::string scene, device;
    Bvh::Config config;
    std::filesystem::path output;
    int repeat = 5;
    bool json = false;
};

constexpr const char* saved_extension = ".cbvh";

struct Report {
    BvhStatistics statistics;
    BvhMemory memory;
    std::uint64_t taken = 0;  // bytes of all buffers, at most
    std::string hash, layout;
    measure::Timing build;                      // no rounds if the structure was loaded
    double load_seconds = 0, save_seconds = 0;  // 0: not done
};

/// The file is at fault if the device builds a valid tree over the same triangles.
[[noreturn]] void refuse_invalid(const Device& device, const BuildOptions& options, bool saved, Bvh& bvh) {
    if (saved) {
        bvh.rebuild();
        if (bvh.validate().ok())
            throw Error(ErrorKind::user,
                        "'" + options.scene + "' is damaged: some of its boxes do not contain their triangles",
                        "build the tree again and save it");
    }
    throw Error(ErrorKind::device, "the tree of " + options.scene + " is not valid on " + device.info().name,
                "report this, with the output of 'claray devices --json'");
}

Report make_report(const Device& device, const BuildOptions& options) {
    Report report;
    const auto begin = std::chrono::steady_clock::now();
    const bool saved = options.scene.ends_with(saved_extension);
    Bvh bvh = saved ? Bvh::load(device, options.scene, options.config.layout)
                    : Bvh::build(device, measure::load_meshes(options.scene), options.config);
    if (saved)
        report.load_seconds = seconds_since(begin);
    else
        report.build = measure::measure_rounds(device, options.repeat, {[&bvh] { bvh.rebuild(); }})[0];
    report.taken = most_bytes_in_use(device);
    report.statistics = bvh.statistics();
    report.memory = memory_needed(device, counts_of(bvh.triangles()), options.config);
    report.hash = bvh.hash();
    report.layout = measure::name_of(measure::layouts, bvh.layout());
    if (!bvh.validate().ok()) refuse_invalid(device, options, saved, bvh);
    if (!options.output.empty()) {
        const auto before = std::chrono::steady_clock::now();
        bvh.save(options.output);
        report.save_seconds = seconds_since(before);
    }
    return report;
}

void print_as_text(const Device& device, const BuildOptions& options, const Report& r) {
    const BvhStatistics& s = r.statistics;
    std::printf("%s on %s\n", options.scene.c_str(), device.info().name.c_str());
    std::printf("tree          %s, %u triangles (%u culled), height %u, SAH cost %.2f, %.1f MB, valid\n",
                r.layout.c_str(), s.triangles, s.culled, s.height, s.sah_cost, double(s.bytes) * 1e-6);
    if (!r.build.rounds.empty())
        std::printf("memory        %s to build, including scratch and triangles; %s taken; the largest buffer %s\n",
                    size_text(r.memory.bytes).c_str(), size_text(r.taken).c_str(),
                    size_text(r.memory.largest_buffer).c_str());
    std::printf("hash          %s\n", r.hash.c_str());
    if (r.load_seconds > 0) std::printf("loaded        in %.2f s\n", r.load_seconds);
    if (!r.build.rounds.empty()) {
        std::printf("build         %.3f ms, %.1f Mtri/s; %.3f ms including pauses between commands; median of %zu\n",
                    r.build.milliseconds(), double(s.triangles) * 1e-3 / r.build.milliseconds(), r.build.span(),
                    r.build.rounds.size());
        std::vector<Row> rows;
        for (const auto& [stage, ms] : r.build.commands) rows.push_back({"  " + stage, fixed(ms, 3) + " ms"});
        print_table(rows, 1);
    }
    if (r.save_seconds > 0)
        std::printf("saved         %s, %.1f MB in %.2f s\n", options.output.c_str(),
                    double(std::filesystem::file_size(options.output)) * 1e-6, r.save_seconds);
}

void print_as_json(const Device& device, const BuildOptions& options, const Report& r) {
    nlohmann::ordered_json report = {{"scene", options.scene},
                                     {"device", device.info().name},
                                     {"layout", r.layout},
                                     {"triangles", r.statistics.triangles},
                                     {"culled", r.statistics.culled},
                                     {"height", r.statistics.height},
                                     {"sah_cost", r.statistics.sah_cost},
                                     {"bytes", r.statistics.bytes},
                                     {"hash", r.hash},
                                     {"valid", true}};
    if (!r.build.rounds.empty())
        report["build"] = {{"milliseconds", r.build.milliseconds()},
                           {"span", r.build.span()},
                           {"memory_bytes", r.memory.bytes},
                           {"taken_bytes", r.taken},
                           {"largest_buffer_bytes", r.memory.largest_buffer},
                           {"stages", r.build.commands}};
    if (r.load_seconds > 0) report["load_seconds"] = r.load_seconds;
    if (r.save_seconds > 0) report["save_seconds"] = r.save_seconds;
    print_json(report);
}

bool is_saved(const std::filesystem::path& path) { return path.extension() == saved_extension; }

void check_build_options(const CLI::App& command, const BuildOptions& options) {
    for (const char* option : {"--builder", "--morton-bits", "--repeat"})
        if (is_saved(options.scene) && command.count(option) > 0)
            throw Error(ErrorKind::usage,
                        std::string(option) + ": '" + options.scene + "' is a saved tree and is not built again",
                        "give the scene from which it was built, or leave the option out");
    if (!options.output.empty() && !is_saved(options.output))
        throw Error(ErrorKind::usage, "--output: '" + options.output.string() + "' is not the name of a saved tree",
                    "use the extension .cbvh");
}

void run_build(const BuildOptions& options) {
    check_outputs({{"--output", options.output}}, {{"the scene", options.scene}});
    const Device device = open_device(options.device);
    const Report report = make_report(device, options);
    options.json ? print_as_json(device, options, report) : print_as_text(device, options, report);
}

}  // namespace

void add_build_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand(
        "build", "Build a tree, print its build time per stage and its quality, and optionally save it");
    command->footer(
        "A saved tree can be loaded on any device by Bvh::load. 'claray build FILE.cbvh' loads and checks it.\n"
        "Instances are copied to their places, into one tree.\n"
        "Example:\n"
        "  claray build scene.obj --builder balanced -o scene.cbvh");
    auto options = std::make_shared<BuildOptions>();
    BuildOptions& o = *options;
    command
        ->add_option("scene", o.scene,
                     "A scene file (" + scene_extensions() + "), a built-in scene, or a saved tree (.cbvh)")
        ->required();
    command->add_option("-o,--output", o.output, "Save the tree and its triangles: FILE.cbvh");
    add_bvh_options(*command, o.config);
    command->add_option("--repeat", o.repeat, "Builds for the median [5]")->transform(whole_number(1, 1000));
    command->add_option("--device", o.device, "cpu, gpu, an index or part of a name (see claray devices)");
    command->add_flag("--json", o.json, "Print the result as JSON");
    command->callback([&action, command, options] {
        check_build_options(*command, *options);
        action = [options] { run_build(*options); };
    });
}

}  // namespace claray::cli
