// claray verify: tests this device and its driver with cases that break ray tracers.
#include "claray/verify.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/base/file.hpp"
#include "host/base/format.hpp"
#include "host/base/message.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/case_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/table.hpp"
#include "host/cli/output/verify_lines.hpp"
#include "host/measure/compare.hpp"
#include "host/verify/probes/reduce.hpp"
#include "host/verify/reports.hpp"

namespace claray::cli {
namespace {

struct VerifyCommandOptions {
    CaseOptions run;
    std::string json;
    std::filesystem::path html, tap, junit, reduce;
    std::vector<std::string> scenes = {"cornell",        "spheres",    "crate",     "hills",     "effects",
                                       "terrain:200000", "soup:50000", "fan:50000", "hair:50000"};
    int rounds = 9;
    bool list = false, compare = false;
};

void list_cases() {
    std::vector<Row> rows = {{"case", "family", "what must hold"}};
    for (const VerifyCase& c : verify_cases()) rows.push_back({c.name, c.family, c.what});
    print_table(rows);
}

std::string svg_of(const VerifyPicture& picture) {
    std::string svg = "<figure><svg viewBox=\"0 0 1 1\" width=\"420\" height=\"420\">";
    for (const VerifyPicture::Shape& shape : picture.shapes) {
        const std::string color = printed("#%06x", unsigned(shape.color));
        if (shape.points.size() == 2) {
            svg += printed("<circle cx=\"%g\" cy=\"%g\" r=\"0.006\" fill=\"", double(shape.points[0]),
                           double(1 - shape.points[1])) +
                   color + "\"/>";
            continue;
        }
        const bool closed = shape.filled || shape.points.size() == 6;
        svg += closed ? "<polygon points=\"" : "<polyline points=\"";
        for (std::size_t i = 0; i + 1 < shape.points.size(); i += 2)
            svg += printed("%g,%g ", double(shape.points[i]), double(1 - shape.points[i + 1]));
        svg += std::string("\" fill=\"") + (shape.filled ? color : "none") + "\" stroke=\"" + color +
               "\" stroke-width=\"0.002\"/>";
    }
    return svg + "</svg><figcaption>" + escaped(picture.title) + "</figcaption></figure>";
}

std::string rows_of(const VerifyResult& result) {
    std::string rows;
    for (const VerifyCheck& c : result.checks)
        rows += std::string("<tr class=\"") + (c.holds() ? "" : "bad") + "\"><td>" + escaped(result.name) + "<td>" +
                escaped(c.what) + "<td>" + std::to_string(c.tried) + "<td>" + number(c.worst) + "<td>" + number(c.bar) +
                "<td>" + escaped(c.unit) + "<td>" + (c.holds() ? "holds" : "FAILS") + "<td>" +
                fixed(result.seconds, 2) + "\n";
    return rows;
}

/// The report as one HTML file, with a picture of the worst case of every failure.
std::string html_of(const DeviceInfo& device, const std::vector<VerifyResult>& results) {
    std::size_t failed = 0;
    std::string rows, details;
    for (const VerifyResult& result : results) {
        rows += rows_of(result);
        if (!result.facts.empty() || !result.holds()) details += "<h2>" + escaped(result.name) + "</h2>\n";
        for (const auto& [name, value] : result.facts)
            details += "<p>" + escaped(name) + ": <code>" + escaped(value) + "</code>\n";
        if (result.holds()) continue;
        ++failed;
        details += "<p>Again: <code>" + escaped(result.command) + "</code>\n";
        for (const std::string& failure : result.failures) details += "<p><code>" + escaped(failure) + "</code>\n";
        for (const VerifyPicture& picture : result.pictures) details += svg_of(picture);
    }
    return "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>claray verify</title>\n"
           "<style>body{font:15px sans-serif;max-width:75em;margin:2em auto}table{border-collapse:collapse}"
           "td,th{padding:.2em .6em;border-bottom:1px solid #ddd;text-align:left}.bad{background:#fbd5cc}"
           "figure{display:inline-block;border:1px solid "
           "#ccc;padding:.5em}code{word-break:break-all}</style>\n<h1>claray verify</h1>\n<p>" +
           escaped(device.name) + ", driver " + escaped(device.driver) + ": " +
           (failed == 0 ? "all " + std::to_string(results.size()) + " cases hold"
                        : std::to_string(failed) + " of " + std::to_string(results.size()) + " cases fail") +
           "\n<table><tr><th>case<th>figure<th>tried<th>worst<th>bar<th>unit<th>verdict<th>seconds\n" + rows +
           "</table>\n" + details + "</html>\n";
}

struct Comparison {
    std::vector<measure::ComparedFailures> failures;
    std::vector<measure::ComparedTimes> times;
    std::vector<measure::ComparedKernel> kernels;
};

void print_comparison(const Comparison& c) {
    std::vector<Row> rows = {
        {"remedy", "the textbook's", "case", "tried", "fails as shipped", "by the textbook", "unit"}};
    for (const auto& f : c.failures)
        rows.push_back({f.remedy, f.textbook, f.verify_case, std::to_string(f.tried), number(f.shipped),
                        number(f.by_textbook), f.unit});
    print_table(rows, 3);
    std::printf(
        "\n"
        "milliseconds to trace, in alternating runs: as usual on this device (with packets and sorting, if it uses "
        "them), with the\n"
        "textbook's tests and as shipped; then the same for single rays\n");
    rows = {{"scene", "rays", "textbook", "shipped", "shipped / textbook", "of least", "of processor time",
             "ray by ray: textbook", "with fast math", "robust", "robust / textbook", "of least", "of processor time"}};
    for (const auto& t : c.times)
        rows.push_back({t.scene, t.rays, fixed(t.shipped.textbook_ms, 2), fixed(t.shipped.robust_ms, 2),
                        fixed(t.shipped.ratio, 3), fixed(t.shipped.least_ratio, 3), fixed(t.shipped.processor, 3),
                        fixed(t.one_by_one.textbook_ms, 2), fixed(t.fast_math_ms, 2), fixed(t.one_by_one.robust_ms, 2),
                        fixed(t.one_by_one.ratio, 3), fixed(t.one_by_one.least_ratio, 3),
                        fixed(t.one_by_one.processor, 3)});
    print_table(rows, 2);
    std::printf(
        "\n"
        "milliseconds of kernels for shading and summing\n");
    rows = {{"remedy", "kernel", "textbook", "as shipped", "shipped / textbook", "of least"}};
    for (const auto& k : c.kernels)
        rows.push_back({k.remedy, k.kernel, fixed(k.textbook_ms, 3), fixed(k.shipped_ms, 3),
                        fixed(k.shipped_ms / k.textbook_ms, 3), fixed(k.least_ratio, 3)});
    print_table(rows, 2);
}

nlohmann::ordered_json as_json(const measure::ComparedPair& p) {
    return {{"textbook_ms", p.textbook_ms},
            {"robust_ms", p.robust_ms},
            {"ratio", p.ratio},
            {"least_ratio", p.least_ratio},
            {"processor_ratio", p.processor}};
}

std::string json_of(const Device& device, const Comparison& c) {
    nlohmann::ordered_json report = {{"device", device.info().name}, {"driver", device.info().driver}};
    for (const auto& f : c.failures)
        report["failures"].push_back({{"remedy", f.remedy},
                                      {"textbook", f.textbook},
                                      {"case", f.verify_case},
                                      {"tried", f.tried},
                                      {"shipped", f.shipped},
                                      {"by_textbook", f.by_textbook},
                                      {"unit", f.unit}});
    for (const auto& t : c.times)
        report["times"].push_back({{"scene", t.scene},
                                   {"rays", t.rays},
                                   {"shipped", as_json(t.shipped)},
                                   {"one_by_one", as_json(t.one_by_one)},
                                   {"fast_math_ms", t.fast_math_ms}});
    for (const auto& k : c.kernels)
        report["kernels"].push_back({{"remedy", k.remedy},
                                     {"kernel", k.kernel},
                                     {"textbook_ms", k.textbook_ms},
                                     {"shipped_ms", k.shipped_ms},
                                     {"least_ratio", k.least_ratio}});
    return json_text(report);
}

void compare(const VerifyCommandOptions& options, const VerifyOptions& how) {
    const Device device = open_device(options.run.device);
    Comparison c;
    for (measure::Remedy remedy : measure::remedies()) {
        if (!options.run.cases.empty())
            std::erase_if(remedy.cases, [&](const std::string& name) {
                return std::ranges::find(options.run.cases, name) == options.run.cases.end();
            });
        for (auto& f : measure::compare_failures(device, remedy, how)) c.failures.push_back(f);
    }
    for (const std::string& scene : options.scenes)
        for (auto& t : measure::compare_times(device, scene, 320, 180, options.rounds)) c.times.push_back(t);
    c.kernels = measure::compare_kernels(device, options.rounds);
    if (options.json != "-") print_comparison(c);
    if (options.json == "-")
        std::fputs(json_of(device, c).c_str(), stdout);
    else if (!options.json.empty())
        write_file(options.json, json_of(device, c));
}

/// Writes what shows the faults without claray.
void reduce(const VerifyCommandOptions& options) {
    const auto say = [](const std::string& line) { std::printf("%s\n", line.c_str()), std::fflush(stdout); };
    std::string device;  // its number
    const auto run = [&](const std::vector<std::string>& names, const auto& report) {
        CaseOptions some = options.run;
        some.cases = names;
        device = std::to_string(run_cases(
                                    some, [](const DeviceInfo&) {}, report)
                                    .device.index);
    };
    Writes writes;
    for (const std::string& name : verify::probes_to_write(options.run.cases, run, say))
        writes.attempt([&] { say(verify::write_probe(options.reduce, name) + ' ' + device); });
    writes.finish();
}

void verify(const VerifyCommandOptions& options) {
    if (options.list) return list_cases();
    const bool json_to_output = options.json == "-";
    check_outputs({{"--json", json_to_output ? "" : options.json},
                   {"--html", options.html},
                   {"--tap", options.tap},
                   {"--junit", options.junit}});
    const VerifyOptions how = options.run.verify_options();
    check_verify_cases(options.run.cases);
    if (options.compare) return compare(options, how);
    if (!options.reduce.empty()) return reduce(options);
    const auto opened = [&](const DeviceInfo& device) {
        if (!json_to_output) print_head(device);
    };
    const auto report = [&](const VerifyResult& result) {
        if (!json_to_output) print_result(result);
    };
    const Verified verified = run_cases(options.run, opened, report);
    const auto& [device, results, seconds] = verified;
    if (how.kernels && !json_to_output) print_kernels(results);
    const std::string json = verify::json_of(device, how, results, seconds);
    Writes writes;
    if (json_to_output)
        std::fputs(json.c_str(), stdout);
    else if (!options.json.empty())
        writes.attempt([&] { write_file(options.json, json); });
    const auto write_report = [&](const std::filesystem::path& path, const auto& text) {
        if (!path.empty()) writes.attempt([&] { write_file(path, text()); });
    };
    write_report(options.html, [&] { return html_of(device, results); });
    write_report(options.tap, [&] { return verify::tap_of(results); });
    write_report(options.junit, [&] { return verify::junit_of(device, results); });
    const bool holds = std::ranges::all_of(results, [](const VerifyResult& r) { return r.holds(); });
    if (!json_to_output && holds)
        std::printf(
            "%s in %.1f s: this device and driver can be trusted with %s\n",
            results.size() == 1 ? "the case holds" : ("all " + std::to_string(results.size()) + " cases hold").c_str(),
            seconds, results.size() == 1 ? "it" : "them");
    std::fflush(stdout);
    refuse_failed(verified);
    writes.finish();
}

}  // namespace

void add_verify_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("verify", "Test this device and driver with cases that break ray tracers");
    command->footer(
        "Every case has a limit. The exit code is 3 if a case fails; each failure prints the command that repeats it.\n"
        "docs/numerics.md describes the cases and the guarantees.\n"
        "Examples:\n"
        "  claray verify --device gpu\n"
        "  claray verify --full --json verify.json --html verify.html\n"
        "  claray verify --case edges --case boxes --seed 7\n"
        "  claray verify --compare --scene hair:50000 --scene sponza.obj");
    auto o = std::make_shared<VerifyCommandOptions>();
    add_case_options(*command, o->run);
    command->add_flag("--list", o->list, "Print the cases");
    command->add_flag("--kernels", o->run.how.kernels,
                      "Print which cases run each kernel, and which kernels none runs");
    command->add_flag("--compare", o->compare,
                      "Compare each remedy with the textbook's version: failures (of --case, if given) and times");
    command->add_option("--scene", o->scenes, "Scenes and files for comparing times [the built-in ones]")
        ->allow_extra_args(false);
    command->add_option("--rounds", o->rounds, "Rounds for comparing times [9]")->transform(whole_number(1, 1000));
    command->add_option("--json", o->json, "Write the results as JSON to this file; - means standard output");
    command->add_option("--html", o->html, "Write an HTML report with pictures of failures");
    command->add_option("--tap", o->tap, "Write the results for the Test Anything Protocol, version 14");
    command->add_option("--junit", o->junit, "Write the results as JUnit's XML, for build servers");
    command->add_option("--reduce", o->reduce,
                        "Write a kernel and a C program to this folder for each probe that fails, or each of --case");
    command->callback([&action, command, o] {
        refuse_contradicting_case_options(*command);
        refuse_without(*command, "--scene", "--compare");
        refuse_without(*command, "--rounds", "--compare");
        refuse_both(*command, "--compare", {"--html", "--tap", "--junit", "--no-times", "--kernels", "--limit"},
                    "--compare prints failures and times");
        refuse_both(*command, "--reduce", {"--compare", "--json", "--html", "--tap", "--junit", "--kernels"},
                    "--reduce writes programs");
        refuse_both(*command, "--list",
                    {"--quick", "--full", "--case", "--compare", "--kernels", "--seed", "--limit", "--no-times",
                     "--json", "--html", "--tap", "--junit", "--reduce", "--device"},
                    "--list runs no case");
        action = [o] { verify(*o); };
    });
}

}  // namespace claray::cli
