// claray tune: finds faster values of the tuning table for this device.
#include "host/measure/tune.hpp"

#include <cstdio>
#include <memory>

#include "claray/io.hpp"
#include "claray/plan/target.hpp"
#include "host/base/file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/output/table.hpp"
#include "host/compute/tuning.hpp"

namespace claray::cli {
namespace {

struct TuneOptions {
    measure::TuneOptions tune;
    std::string device;
    std::filesystem::path output;
    bool dry_run = false;
};

std::string verdict(const measure::Trial& trial) {
    if (!trial.failure.empty()) return trial.failure;
    if (trial.in_force) return "in force";
    return trial.kept ? "kept" : "";
}

void print_trials(const std::vector<measure::Trial>& trials) {
    std::vector<Row> rows = {{trials.at(0).kernel + " " + trials[0].parameter, "ms", "time", "noise", ""}};
    for (const measure::Trial& trial : trials) {
        const bool failed = !trial.failure.empty();
        rows.push_back({"  " + std::to_string(trial.value), failed ? "" : fixed(trial.milliseconds, 3),
                        failed ? "" : fixed(trial.ratio, 3), failed ? "" : fixed(trial.noise, 3), verdict(trial)});
    }
    print_table(rows, 1);
    std::fflush(stdout);
}

std::filesystem::path choose_output(const TuneOptions& options) {
    const std::filesystem::path path = options.output.empty() ? local_tuning_path() : options.output;
    if (path.empty())
        throw Error(ErrorKind::usage, "no folder for the tuning table: XDG_CONFIG_HOME and HOME are not set",
                    "give a file: -o FILE");
    if (options.output.empty()) make_folder(path.parent_path());
    check_file_writable(path);
    return path;
}

void refuse_no_match(const std::string& only, const std::vector<measure::TuningCandidates>& candidates) {
    std::string kernels = "plan/model";
    bool any = kernels.find(only) != std::string::npos;
    for (const measure::TuningCandidates& of : candidates) {
        any = any || (of.kernel + " " + of.parameter).find(only) != std::string::npos;
        if (!kernels.ends_with(of.kernel)) kernels += ", " + of.kernel;
    }
    if (!any)
        throw Error(ErrorKind::usage, "--only: no parameter contains '" + only + "'", "choose part of " + kernels);
}

/// The rows that the planner of `claray render --error`, `--time` and `--fps` uses.
std::vector<measure::TunedRow> measured_model(const Device& device, const std::string& only) {
    if (std::string("plan/model").find(only) == std::string::npos) return {};
    const DeviceModel model = measure_model(device);
    std::vector<Row> table = {{"plan/model", "build ns/triangle", "samples/s"}};
    for (const Builder builder : planned_builders) {
        const DeviceModel::Preset& preset = model.of(builder);
        table.push_back({std::string("  ") + traits_of(builder).name, fixed(preset.build_nanoseconds, 1),
                         fixed(preset.samples_per_second, 0)});
    }
    print_table(table, 1);
    std::printf("  independent samples need %.2f times the time of Sobol samples for the same error\n",
                model.independent_cost);
    std::vector<measure::TunedRow> rows;
    for (const ModelRow& row : rows_of(model)) rows.push_back({row.kernel, row.parameter, row.value, 1, true});
    return rows;
}

void run_tune(const TuneOptions& options) {
    const std::filesystem::path output = options.dry_run ? std::filesystem::path() : choose_output(options);
    const Device device = open_device(options.device);
    const std::vector<measure::TuningCandidates> candidates = measure::candidates_for(device.info());
    refuse_no_match(options.tune.only, candidates);
    std::printf("%s, driver %s; paired medians of %d interleaved rounds by the device's clock\n",
                device.info().name.c_str(), device.info().driver.c_str(), options.tune.repeat);
    auto rows = measure::tune(device, options.tune, candidates, print_trials);
    for (const measure::TunedRow& row : measured_model(device, options.tune.only)) rows.push_back(row);
    if (rows.empty()) {
        std::printf("no value is faster than the current one\n");
        return;
    }
    if (options.dry_run) {
        std::printf("rows for a tuning table:\n%s", measure::with_rows("", device.info(), rows).c_str());
        return;
    }
    std::error_code none;
    const std::string before = std::filesystem::exists(output, none) ? read_file(output, "check the path") : "";
    write_file(output, measure::with_rows(before, device.info(), rows));
    std::printf("%zu rows written to %s%s\n", rows.size(), output.c_str(),
                options.output.empty() ? "" : "; set CLARAY_TUNING to this file to use it");
}

}  // namespace

void add_tune_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("tune", "Find faster values of the tuning table for a device");
    command->footer(
        "Candidate values are in kernels/tuning_candidates.txt. 'time' is relative to the current value ('in force').\n"
        "A value is kept if it saves at least 2 % and twice the noise in two measurements, and changes no result.\n"
        "Without -o the rows are written to $XDG_CONFIG_HOME/claray/tuning.txt, which is read whenever a device is\n"
        "opened. claray render --error, --time and --fps use the rows plan/model; --only plan/model measures only "
        "these.\n"
        "Example:\n"
        "  claray tune --device gpu --scene terrain:1000000 --size 960x540 --only trace/");
    auto options = std::make_shared<TuneOptions>();
    TuneOptions& o = *options;
    o.tune.scenes = {"soup:30000", "terrain:100000"};
    command->add_option("--scene,scenes", o.tune.scenes, "Scenes to measure with [soup:30000 terrain:100000]");
    add_size_option(*command, o.tune.width, o.tune.height, "WIDTHxHEIGHT of each of the three views [192x108]");
    command->add_option("--repeat", o.tune.repeat, "Rounds to measure [9]")->transform(whole_number(3, 1000));
    command->add_option("--only", o.tune.only, "Only parameters whose 'kernel PARAMETER' contains this text");
    command->add_option("--device", o.device, "cpu, gpu, an index or part of a name (see claray devices)");
    command->add_option("-o,--output", o.output, "Tuning table to which the rows are added");
    command->add_flag("--dry-run", o.dry_run, "Print the rows, do not write them");
    command->callback([&action, command, options] {
        refuse_both(*command, "--dry-run", {"--output"}, "--dry-run writes nothing");
        action = [options] { run_tune(*options); };
    });
}

}  // namespace claray::cli
