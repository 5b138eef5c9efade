// claray accuracy: error against time, for every setting of the methods that make an image.
#include "claray/accuracy.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iterator>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <thread>

#include "host/accuracy/rehearsal.hpp"
#include "host/accuracy/study.hpp"
#include "host/accuracy/study_list.hpp"
#include "host/base/file.hpp"
#include "host/base/folders.hpp"
#include "host/base/seconds_since.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/options/view_options.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/progress.hpp"
#include "host/cli/output/study_files.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

struct AccuracyOptions {
    std::string scene, device, only;
    ViewOptions view;
    StudyOptions study;
    StudyPaths files;
    bool quick = false, json = false, quiet = false, check = false;
    bool has_size = false, has_spp = false, has_rays = false;  // given by the user
};

std::string study_names() {
    std::string names;
    for (const NamedStudy& study : all_studies) names += (names.empty() ? "" : ", ") + std::string(study.name);
    return names;
}

std::vector<NamedStudy> chosen_studies(const std::string& names) {
    if (names.empty()) return {std::begin(all_studies), std::end(all_studies)};
    std::vector<NamedStudy> chosen;
    std::istringstream list(names);
    for (std::string name; std::getline(list, name, ',');) {
        const auto found = std::find_if(std::begin(all_studies), std::end(all_studies),
                                        [&](const NamedStudy& study) { return name == study.name; });
        if (found == std::end(all_studies))
            throw Error(ErrorKind::usage, "--only: unknown study '" + name + "'", "choose from " + study_names());
        chosen.push_back(*found);
    }
    return chosen;
}

/// Prints the fraction done and the time left at this pace. An interruption ends the study.
AccuracyProgress show_progress(const std::string& study, bool quiet) {
    const auto begin = std::chrono::steady_clock::now();
    const auto shown = std::make_shared<double>(-1);
    return [=](double done, const std::string& what) {
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (!quiet && (seconds - *shown > 2 || done >= 1)) {
            *shown = seconds;
            // The first steps are no measure: they include compilation.
            const bool known = done >= 0.02 && done < 1 && seconds > 1;
            std::fprintf(stderr, "%s: %3.0f %%, %s, %s%s\n", study.c_str(), 100 * done, what.c_str(),
                         duration_text(known ? seconds * (1 - done) / done : seconds).c_str(),
                         known ? " left" : " so far");
        }
        if (InterruptGuard::interrupted()) throw Error(ErrorKind::user, "interrupted");
        return true;
    };
}

void print_study(const Study& study) {
    if (study.points.empty()) {
        std::printf("\n%s: no points", study.name.c_str());
        for (const std::string& finding : study.findings) std::printf(": %s", finding.c_str());
        std::printf("\n");
        return;
    }
    std::printf("\n%s: %s against %s", study.title.c_str(), study.error.c_str(), study.cost.c_str());
    std::printf(", on %s, driver %s", study.device.c_str(), study.driver.c_str());
    if (study.reference_spp != 0)
        std::printf("; reference of %u samples per pixel, its own error %s", study.reference_spp,
                    number(study.floor).c_str());
    std::printf("\n");
    const std::vector<std::string> facts = fact_names(study);
    Row head = {"method", "setting", "error", "quartiles"};
    head.insert(head.end(), facts.begin(), facts.end());
    head.insert(head.end(), {study.cost, "quartiles", "front"});
    std::vector<Row> rows = {head};
    for (const StudyPoint& p : study.points) {
        const bool failed = !p.failure.empty();
        const auto cell = [&](double value) { return failed || std::isnan(value) ? "-" : number(value); };
        Row row = {p.method, p.setting, cell(p.error.median),
                   failed ? "-" : number(p.error.low) + ".." + number(p.error.high)};
        for (const std::string& fact : facts) row.push_back(cell(fact_of(p, fact)));
        row.push_back(failed ? "-" : number(p.seconds.median));
        row.push_back(failed ? "-" : number(p.seconds.low) + ".." + number(p.seconds.high));
        row.push_back(failed ? p.failure : p.front ? "yes" : "");
        rows.push_back(row);
    }
    print_table(rows, 2);
    for (const std::string& finding : study.findings) std::printf("%s\n", finding.c_str());
    std::printf("the study took %s\n", duration_text(study.took).c_str());
}

/// A row per point: its error by both references.
void print_check(const ErrorCheck& check) {
    std::vector<Row> rows = {{"method", "setting", "error", "independent", "ratio"}};
    for (std::size_t i = 0; i < check.reported.points.size(); ++i) {
        const StudyPoint &a = check.reported.points[i], &b = check.independent.points[i];
        if (a.failure.empty() && b.failure.empty())
            rows.push_back({a.method, a.setting, number(a.error.median), number(b.error.median),
                            fixed(a.error.median / b.error.median, 4)});
    }
    print_table(rows, 2);
    std::printf(
        "%u of %u points are within 10 %% of the error against an independent reference of %u samples per pixel, the "
        "largest difference is %.2f %%\n"
        "independent sampler: the error is proportional to the samples to the power of %.3f\n",
        check.within, check.points, check.independent.reference_spp, 100 * check.worst, check.slope);
}

nlohmann::ordered_json as_json(const Spread& s) { return {{"low", s.low}, {"median", s.median}, {"high", s.high}}; }

std::string today() {
    const std::time_t now = std::time(nullptr);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", std::localtime(&now));
    return text;
}

void print_as_json(const std::vector<Study>& studies, const AccuracyOptions& o, const Device& device) {
    nlohmann::ordered_json report = {
        {"scene", o.scene}, {"device", device.info().name},  {"driver", device.info().driver},
        {"date", today()},  {"width", o.study.config.width}, {"height", o.study.config.height}};
    for (const Study& study : studies) {
        nlohmann::ordered_json points = nlohmann::ordered_json::array();
        for (const StudyPoint& p : study.points) {
            points.push_back({{"method", p.method},
                              {"setting", p.setting},
                              {"value", p.value},
                              {"runs", p.runs},
                              {"error", as_json(p.error)},
                              {"relmse", p.errors.relmse},
                              {"perceptual", p.errors.perceptual},
                              {"seconds", as_json(p.seconds)},
                              {"front", p.front},
                              {"failure", p.failure}});
            for (const auto& [name, value] : p.facts) points.back()["facts"][name] = value;
        }
        report["studies"].push_back({{"name", study.name},
                                     {"device", study.device},
                                     {"driver", study.driver},
                                     {"error", study.error},
                                     {"cost", study.cost},
                                     {"floor", study.floor},
                                     {"reference_spp", study.reference_spp},
                                     {"took", study.took},
                                     {"findings", study.findings},
                                     {"points", points}});
    }
    print_json(report);
}

/// As the user gave them. Of all studies, those that render the scene come first: they begin with a reference, which is
/// not timed, so that other kernels can be compiled meanwhile.
std::vector<std::size_t> order_of(const std::vector<NamedStudy>& studies, bool all) {
    std::vector<std::size_t> order(studies.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    if (all) std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return studies[i].samples; });
    return order;
}

/// Each device takes the next study when it is done with one. An error on one device ends them all.
void run_studies(const std::vector<NamedStudy>& chosen, const std::vector<Device>& devices, const Scene& scene,
                 const AccuracyOptions& o, StudyFiles& files) {
    const std::vector<std::size_t> order = order_of(chosen, o.only.empty());
    std::vector<NamedStudy> in_order;
    for (const std::size_t i : order) in_order.push_back(chosen[i]);
    Rehearsal rehearsal(devices.front(), scene, o.study, std::move(in_order));
    std::atomic<std::size_t> next = 0;
    std::mutex failing;
    std::exception_ptr failure;
    const auto run = [&](const Device& device, std::size_t i) {
        const auto begin = std::chrono::steady_clock::now();
        const auto with_device = [&](Study study) {
            study.device = device.info().name, study.driver = device.info().driver;
            study.took = seconds_since(begin);
            return study;
        };
        const AccuracyProgress show = show_progress(chosen[i].name, o.quiet);
        const AccuracyProgress progress = [&](double share, const std::string& what) {
            if (next > chosen.size() + devices.size()) throw Error(ErrorKind::user, "another study failed");
            return show(share, what);
        };
        StudyOptions options = o.study;
        const auto wait = [&] { rehearsal.wait([&] { (void)progress(0, "compiling kernels"); }); };
        if (i == order.front() && chosen[i].samples)
            options.before_timing = wait;
        else
            wait();
        options.measured = [&, i](const Study& so_far) { files.update(i, with_device(so_far)); };
        std::vector<ErrorMap> maps;
        const NamedStudy& study = chosen[i];
        Study done = with_device(
            study.run ? study.run(device, scene, options, progress)
                      : study.run_with_maps(device, scene, options, progress, o.files.maps.empty() ? nullptr : &maps));
        if (!o.quiet) std::fprintf(stderr, "%s: took %s\n", study.name, duration_text(done.took).c_str());
        files.finish(i, std::move(done), std::move(maps));
    };
    const auto work = [&](const Device& device) {
        try {
            for (std::size_t i = next++; i < chosen.size(); i = next++) run(device, order[i]);
        } catch (...) {
            const std::lock_guard lock(failing);
            if (!failure) failure = std::current_exception();
            next = 2 * (chosen.size() + devices.size());
        }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t d = 1; d < devices.size(); ++d) others.emplace_back(work, devices[d]);
        work(devices.front());
    }
    if (failure) std::rethrow_exception(failure);
}

/// Prints the finished studies. Files have the points of unfinished ones, too.
[[noreturn]] void refuse_incomplete(const Error& error, const StudyFiles& files, std::size_t all,
                                    const AccuracyOptions& o, const Device& device) {
    const std::vector<Study> studies = files.finished();
    if (o.json && !studies.empty()) print_as_json(studies, o, device);
    if (!o.json)
        for (const Study& study : studies) print_study(study);
    std::fflush(stdout);
    files.write();
    const std::string share = std::to_string(studies.size()) + " of " + std::to_string(all) + " studies";
    const std::string_view text = error.what(), line = text.substr(0, text.find('\n')),
                           report = text.substr(line.size());
    throw Error(error.kind(), std::string(line), share + " are finished and printed; files have what was measured",
                std::string(report.substr(report.empty() ? 0 : 1)));
}

/// All files but the maps of single effects, whose names are known only later.
std::vector<NamedFile> outputs_of(const AccuracyOptions& o, const std::vector<NamedStudy>& chosen) {
    std::vector<NamedFile> outputs = {{"--csv", o.files.csv}, {"--html", o.files.html}, {"--svg", o.files.svg}};
    if (!o.files.svgs.empty())
        for (const NamedStudy& study : chosen)
            outputs.push_back({"--svgs", o.files.svgs / (std::string(study.name) + ".svg")});
    if (!o.files.maps.empty()) outputs.push_back({"--maps", o.files.maps / "noise.pfm"});
    return outputs;
}

/// What a fast device is given more of: settings that take less measure the start of kernels.
constexpr StudyScale quick{.seconds = 0.005, .span = 32};

void limit_to_quick(StudyOptions& study) {
    const auto limit = [](auto& value, unsigned most) { value = std::min<std::size_t>(value, most); };
    limit(study.most_spp, quick.span), limit(study.runs, 3), limit(study.rays, 1u << 16);
    limit(study.config.width, 64), limit(study.config.height, 64);
}

/// What the user did not give is chosen by the speed of the device, if a chosen study renders the scene.
void scale_to_device(AccuracyOptions& o, const std::vector<NamedStudy>& chosen, const Device& device,
                     const Scene& scene) {
    const bool samples =
        std::any_of(chosen.begin(), chosen.end(), [](const NamedStudy& study) { return study.samples; });
    if ((o.has_size && o.has_spp) || !samples) return;
    o.study = at_scale(device, scene, o.study, o.has_size, o.has_spp, o.has_rays, o.quick ? quick : StudyScale());
    if (!o.quiet)
        std::fprintf(stderr, "chosen for this device: %ux%u pixels, %u to %u samples per pixel\n", o.study.config.width,
                     o.study.config.height, o.study.first_spp, o.study.most_spp);
}

void accuracy(AccuracyOptions o) {
    const std::vector<NamedStudy> chosen = chosen_studies(o.only);
    if (!o.files.maps.empty()) {
        if (std::none_of(chosen.begin(), chosen.end(), [](const NamedStudy& s) { return s.run == nullptr; }))
            throw Error(ErrorKind::usage, "--maps needs the study effects or depth", "add one to --only");
        make_folder(o.files.maps);
    }
    if (!o.files.svg.empty() && chosen.size() != 1)
        throw Error(ErrorKind::usage, "--svg plots one study", "select it with --only, or use --html");
    if (!o.files.svgs.empty()) make_folder(o.files.svgs);
    check_outputs(outputs_of(o, chosen), {{"the scene", o.scene}});
    if (o.quick) limit_to_quick(o.study);
    const Scene scene = load_view(o.scene, o.view, o.study.config.width, o.study.config.height);
    const std::vector<Device> devices = open_devices(o.device);
    const Device& device = devices.front();
    const InterruptGuard guard;
    scale_to_device(o, chosen, device, scene);
    std::shared_ptr<const std::filesystem::path> kept;  // references, which all studies share
    if (o.study.references.empty()) o.study.references = *(kept = scratch_folder());
    if (o.check) return print_check(check_errors(device, scene, o.study, show_progress("check", o.quiet)));
    const std::string subtitle = o.scene + ", " + std::to_string(o.study.config.width) + "x" +
                                 std::to_string(o.study.config.height) + ", " + today();
    StudyFiles files(o.files, o.scene, subtitle, o.study.config, chosen.size());
    try {
        run_studies(chosen, devices, scene, o, files);
    } catch (const Error& error) {
        refuse_incomplete(error, files, chosen.size(), o, device);
    }
    const std::vector<Study> studies = files.finished();
    if (o.json) {
        print_as_json(studies, o, device);
        return files.write();
    }
    std::printf("%s\n", subtitle.c_str());
    for (const Study& study : studies) print_study(study);
    const std::vector<std::string> summary = summary_of(studies);
    if (!summary.empty()) std::printf("\nWhat matters most\n");
    for (const std::string& fact : summary) std::printf("%s\n", fact.c_str());
    files.write();
}

}  // namespace

void add_accuracy_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("accuracy", "Measure and plot accuracy against time");
    command->footer(
        "Studies: hard-rays and scene-rays (triangle and box tests), builds, trees, nodes, sampling (samples per "
        "pixel, by\n"
        "sampler), techniques (of sampling), denoising, bias, arithmetic, sums, filtering, depth (buffers), gamma\n"
        "(lights added as sRGB values), shading, effects (see docs/accuracy.md).\n"
        "Examples:\n"
        "  claray accuracy cornell --quick\n"
        "  claray accuracy scene.gltf --device gpu --size 512x512 --spp 1024 --html accuracy.html --csv accuracy.csv");
    auto o = std::make_shared<AccuracyOptions>();
    command->add_option("scene", o->scene, "A scene file, or a built-in scene (see claray scenes)")->required();
    command->add_option("--only", o->only, "Run these studies only: NAME,NAME...");
    command->add_flag("--quick", o->quick,
                      "64x64 pixels and 32 samples, or more where these take less than 0.2 s; 3 runs");
    add_size_option(*command, o->study.config.width, o->study.config.height,
                    "WIDTHxHEIGHT in pixels [128x128 to 1024x1024, by the speed of the device]");
    command->add_option("--spp", o->study.most_spp, "Largest number of samples per pixel [128 times those of 20 ms]")
        ->transform(whole_number(1, 65536));
    command->add_option("--runs", o->study.runs, "Repetitions, each with its own seed [5]")
        ->transform(whole_number(1, 1000));
    command
        ->add_option("--rays", o->study.rays,
                     "Rays in studies that render no image [262144; up to 2097152 on fast devices]")
        ->transform(whole_number(1024, 1 << 27));
    add_view_options(*command, o->view);
    add_approximate_option(*command, o->study.approximations,
                           "What the study bias measures: approximations, each alone, or nothing [all]");
    command->add_option("--max-depth", o->study.config.max_depth, "Surfaces per path, at most [128]")
        ->transform(whole_number(1, 1024));
    command->add_option("--references", o->study.references, "Folder in which references are kept and continued");
    command->add_option("--csv", o->files.csv, "Write all points as CSV");
    command->add_option("--html", o->files.html, "Write a report with plots");
    command->add_option("--svg", o->files.svg, "Write the plot of one study");
    command->add_option("--svgs", o->files.svgs, "Folder for the plots of all studies");
    command->add_option("--maps", o->files.maps,
                        "Folder for error maps (PFM and PNG): without each effect; of each depth buffer");
    command->add_flag("--check", o->check,
                      "Check the errors of the study sampling against a reference with 16 times the samples");
    command->add_flag("--json", o->json, "Print as JSON");
    command->add_option("--device", o->device,
                        "cpu, gpu, an index or part of a name (see claray devices); several take turns with the "
                        "studies: all, or a list such as gpu,cpu. The first one decides sizes");
    command->add_flag("-q,--quiet", o->quiet, "Print no progress");
    command->callback([&action, command, o] {
        refuse_both(*command, "--check", {"--only", "--csv", "--html", "--svg", "--svgs", "--maps", "--json"},
                    "--check is a separate study and prints a table");
        o->has_size = command->count("--size") > 0, o->has_spp = command->count("--spp") > 0;
        o->has_rays = command->count("--rays") > 0;
        action = [o] { accuracy(*o); };
    });
}

}  // namespace claray::cli
