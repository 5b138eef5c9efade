// claray explain: which effects a scene uses, why, and what they cost.
#include "host/measure/explain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/io.hpp"
#include "host/accuracy/svg.hpp"
#include "host/base/file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/options/view_options.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

using measure::ExplainedApproximation;
using measure::ExplainedEffect;
using measure::Explanation;
using measure::Variant;

struct ExplainOptions {
    std::string scene, device, effects, only;
    ViewOptions view;
    RenderConfig config = {.width = 128, .height = 128};
    measure::ExplainOptions measure;
    std::filesystem::path svg;
    bool json = false, quiet = false, unused = false;
};

/// Milliseconds that the effect adds to a frame, or would add if the scene used it.
double cost(const ExplainedEffect& e, const Variant& own) {
    return e.called_for ? own.milliseconds * (1 - e.ratio) : own.milliseconds * (e.ratio - 1);
}

double compile_cost(const ExplainedEffect& e) {
    const double difference = e.other.compile_milliseconds - e.own_compile_milliseconds;
    return e.called_for ? -difference : difference;
}

std::string reason(const EffectCause& cause) {
    if (cause.count == 0) return "nothing";
    return cause.count == 1 ? cause.first : cause.first + " and " + std::to_string(cause.count - 1) + " more";
}

std::string told(const std::optional<unsigned>& value) { return value ? std::to_string(*value) : "not told"; }

std::string kilobytes(double bytes) { return fixed(bytes * 1e-3, 1); }

Row row_of(const ExplainedEffect& e, const Variant& own, bool compile_times) {
    Row row = {name_of(e.effect), e.called_for ? reason(e.cause) : "-"};
    if (e.fixed) {
        row.insert(row.end(), 6, "-");
        return row;
    }
    const double with = e.called_for ? own.milliseconds : own.milliseconds * e.ratio;
    const double without = e.called_for ? own.milliseconds * e.ratio : own.milliseconds;
    const double bytes = e.called_for ? double(own.bytes) - double(e.other.bytes) : 0;
    const Variant& other = e.other;
    row.insert(row.end(), {fixed(with, 3), fixed(without, 3), e.noise ? "noise" : fixed(cost(e, own), 3),
                           compile_times ? fixed(compile_cost(e), 0) : "-", kilobytes(bytes), told(other.registers)});
    return row;
}

void print_variant(const char* name, const Variant& v, bool compile_times) {
    const std::string compiled = compile_times ? "compiled in " + fixed(v.compile_milliseconds, 0) + " ms, " : "";
    std::printf("%-20s %.3f ms a frame, %s%.1f kB on the device, registers: %s, spilled bytes: %s\n", name,
                v.milliseconds, compiled.c_str(), double(v.bytes) * 1e-3, told(v.registers).c_str(),
                told(v.spill_bytes).c_str());
}

/// Printed first, since measuring takes minutes.
void print_called_for(const std::vector<ExplainedEffect>& effects, const ExplainOptions& o, const Device& device) {
    std::printf("%s on %s, %ux%u, one sample per pixel, uses:\n", o.scene.c_str(), device.info().name.c_str(),
                o.config.width, o.config.height);
    for (const ExplainedEffect& e : effects)
        if (e.called_for) std::printf("  %-24s %s\n", name_of(e.effect), reason(e.cause).c_str());
    std::fflush(stdout);
}

/// Explains figures that could be misread.
void print_notes(const Explanation& x, bool compile_times) {
    const auto any = [&](auto test) { return std::any_of(x.effects.begin(), x.effects.end(), test); };
    if (any([](const ExplainedEffect& e) { return e.noise; }))
        std::printf(
            "noise: fewer than five rounds, or the rounds disagree about which is slower; more --rounds may help\n");
    if (compile_times && any([](const ExplainedEffect& e) { return !e.fixed && compile_cost(e) < 0; }))
        std::printf(
            "compile times are measured once and vary by some percent; therefore some differences are below 0\n");
}

void print_approximations(const Explanation& x, bool compile_times) {
    for (const ExplainedApproximation& a : x.approximations)
        std::printf("--approximate %s: %s the time of a frame; the image differs by %.3g %% (docs/effects.md)\n",
                    to_string(a.approximate).c_str(), a.noise ? "about" : (fixed(a.ratio, 2) + " times").c_str(),
                    100 * a.error);
    print_notes(x, compile_times);
}

/// Kernels of all effects take a GPU's driver a minute to compile.
bool is_everything_measured(const ExplainOptions& o) { return o.unused || !o.only.empty(); }

void print_text(const Explanation& x, const ExplainOptions& o) {
    const bool compile_times = o.measure.compile_times;
    if (!o.effects.empty()) std::printf("effects are overridden: %s\n", o.effects.c_str());
    for (const bool called_for : {true, false}) {
        std::vector<Row> rows = {{called_for ? "called for" : "left out", "by", "ms with", "ms without", "ms more",
                                  "compile ms more", "kB", "registers"}};
        rows[0].back() += called_for ? " without" : " with";
        for (const ExplainedEffect& e : x.effects)
            if (e.called_for == called_for) rows.push_back(row_of(e, x.own, compile_times));
        std::printf("\n");
        if (rows.size() > 1) print_table(rows, 2);
    }
    if (o.only.empty() && !o.unused) std::printf("--unused also measures the effects that the scene does not use\n");
    std::printf("\n");
    print_variant("the scene's own", x.own, compile_times);
    if (!is_everything_measured(o)) return print_approximations(x, compile_times);
    print_variant("everything", x.full, compile_times);
    std::printf("without unused effects: %s",
                x.full_noise ? "no measurable difference" : (fixed(x.full_ratio, 2) + " times as fast").c_str());
    if (compile_times)
        std::printf(", %.0f ms less to compile", x.full.compile_milliseconds - x.own.compile_milliseconds);
    std::printf("\n");
    print_approximations(x, compile_times);
}

nlohmann::ordered_json told_json(const std::optional<unsigned>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json as_json(const Variant& v) {
    return {{"milliseconds", v.milliseconds},
            {"compile_milliseconds", v.compile_milliseconds},
            {"bytes", v.bytes},
            {"registers", told_json(v.registers)},
            {"spill_bytes", told_json(v.spill_bytes)}};
}

nlohmann::ordered_json as_json(const ExplainedEffect& e, const Variant& own) {
    nlohmann::ordered_json row = {{"name", name_of(e.effect)},
                                  {"called_for", e.called_for},
                                  {"by", e.called_for ? nlohmann::ordered_json(e.cause.first) : nullptr},
                                  {"count", e.cause.count}};
    if (e.fixed) return row;
    row["milliseconds_more"] = cost(e, own);
    row["compile_milliseconds_more"] = compile_cost(e);
    row["bytes"] = e.called_for ? std::int64_t(own.bytes) - std::int64_t(e.other.bytes) : 0;
    row["ratio"] = e.ratio;
    row["noise"] = e.noise;
    row[e.called_for ? "without" : "with"] = as_json(e.other);
    return row;
}

void print_as_json(const Explanation& x, const ExplainOptions& o, const Device& device) {
    nlohmann::ordered_json effects = nlohmann::ordered_json::array();
    for (const ExplainedEffect& e : x.effects) effects.push_back(as_json(e, x.own));
    nlohmann::ordered_json approximations = nlohmann::ordered_json::array();
    for (const ExplainedApproximation& a : x.approximations)
        approximations.push_back(
            {{"name", to_string(a.approximate)}, {"ratio", a.ratio}, {"noise", a.noise}, {"error", a.error}});
    const bool measured = is_everything_measured(o);
    const nlohmann::ordered_json none;
    const nlohmann::ordered_json report = {{"scene", o.scene},
                                           {"device", device.info().name},
                                           {"width", o.config.width},
                                           {"height", o.config.height},
                                           {"effect_overrides", o.effects},
                                           {"own", as_json(x.own)},
                                           {"full", measured ? as_json(x.full) : none},
                                           {"full_ratio", measured ? nlohmann::ordered_json(x.full_ratio) : none},
                                           {"effects", effects},
                                           {"approximations", approximations}};
    print_json(report);
}

struct Bar {
    std::string label;
    double value = 0;
    bool strong = true;  ///< an effect that the scene uses; others are drawn in a pale colour
    bool noise = false;  ///< the value does not differ measurably from 0: no bar is drawn
};

std::string bar_chart(const std::string& title, const std::string& subtitle, const std::vector<Bar>& bars) {
    constexpr double width = 760, label_width = 170, value_width = 80, top = 92, pitch = 26, thickness = 16;
    constexpr const char *strong_color = "#2a6f97", *weak_color = "#b8c4cc", *ink = "#222", *pale_ink = "#666";
    using svg::rectangle, svg::text;
    double lowest = 0, highest = 0;
    for (const Bar& bar : bars)
        if (!bar.noise) lowest = std::min(lowest, bar.value), highest = std::max(highest, bar.value);
    const double height = top + pitch * double(bars.size()) + 14;
    // Room for the numbers: right of positive bars, left of negative ones.
    const double left = label_width + (lowest < 0 ? value_width : 12), right = width - value_width;
    const double scale = highest > lowest ? (right - left) / (highest - lowest) : 0, zero = left - lowest * scale;
    std::string svg = svg::begin(width, height);
    svg += text(16, 28, "start", 18, ink, title) + text(16, 48, "start", 12, pale_ink, subtitle);
    svg += rectangle(16, 62, 12, 12, strong_color) + text(34, 72, "start", 12, ink, "called for: cost in this scene");
    svg += rectangle(256, 62, 12, 12, weak_color) + text(274, 72, "start", 12, ink, "left out: cost if it were used");
    double y = top;
    for (const Bar& bar : bars) {
        const double value = bar.noise ? 0 : bar.value, length = std::abs(value) * scale, end = zero + value * scale;
        const double baseline = y + 0.5 * thickness + 4;
        svg += text(label_width, baseline, "end", 12, ink, bar.label);
        svg +=
            rectangle(std::min(zero, end), y, std::max(length, 1.0), thickness, bar.strong ? strong_color : weak_color);
        svg += text(value < 0 ? end - 5 : end + 5, baseline, value < 0 ? "end" : "start", 12, pale_ink,
                    bar.noise ? "noise" : fixed(value, 3));
        y += pitch;
    }
    svg += rectangle(zero, top - 4, 1, pitch * double(bars.size()), ink);
    return svg + "</svg>\n";
}

void write_svg(const Explanation& x, const ExplainOptions& o, const Device& device) {
    const std::string subtitle = "milliseconds per frame of " + fixed(x.own.milliseconds, 2) + " ms (" +
                                 std::to_string(o.config.width) + "x" + std::to_string(o.config.height) +
                                 ", one sample per pixel) on " + device.info().name;
    std::vector<Bar> bars;
    for (const ExplainedEffect& e : x.effects)
        if (!e.fixed) bars.push_back({name_of(e.effect), cost(e, x.own), e.called_for, e.noise});
    if (is_everything_measured(o))
        bars.push_back({"everything", x.own.milliseconds * (x.full_ratio - 1), false, x.full_noise});
    write_file(o.svg, bar_chart("Cost of the effects of " + o.scene, subtitle, bars));
}

/// Divides --only into effects and approximations.
void restrict_to(const std::string& names, measure::ExplainOptions& measure) {
    const std::vector<std::string> approximations = split(to_string(all_approximations()));
    std::string of_effects, of_approximations;
    for (const std::string& name : split(names)) {
        std::string& of =
            std::count(approximations.begin(), approximations.end(), name) > 0 ? of_approximations : of_effects;
        of += (of.empty() ? "" : ",") + name;
    }
    measure.only = of_effects.empty() ? EffectSet() : parse_effects(of_effects);
    measure.approximations = of_approximations.empty() ? Approximations() : parse_approximations(of_approximations);
}

void explain(const ExplainOptions& options) {
    check_outputs({{"--svg", options.svg}}, {{"the scene", options.scene}});
    RenderConfig config = options.config;
    if (!options.effects.empty()) config.effects = parse_effect_overrides(options.effects);
    if (!config.effects.add.empty())
        throw Error(ErrorKind::usage, "--effects: explain measures all effects that can be added",
                    "use -NAME to remove effects from the scene first");
    measure::ExplainOptions measure = options.measure;
    if (!options.only.empty()) restrict_to(options.only, measure);
    const Scene scene = load_view(options.scene, options.view, config.width, config.height);
    measure.everything = is_everything_measured(options);
    if (!measure.everything) measure.only = effects_of(scene);
    const Device device = open_device(options.device);
    if (!options.json) print_called_for(measure::effects_to_explain(scene, config, measure.only), options, device);
    const Explanation explanation = measure::explain(device, scene, config, measure, [&](const std::string& what) {
        if (!options.quiet) std::fprintf(stderr, "%s\n", what.c_str());
    });
    options.json ? print_as_json(explanation, options, device) : print_text(explanation, options);
    if (!options.svg.empty()) write_svg(explanation, options, device);
}

}  // namespace

void add_explain_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("explain", "Show which effects a scene uses, why, and the cost of each");
    command->footer(
        "Every effect of the scene is compared with the scene's own kernels, with the same samples, alternating "
        "between the two.\n"
        "For the error per pixel without each effect: claray accuracy SCENE --only effects --maps FOLDER.\n"
        "Examples:\n"
        "  claray explain spheres\n"
        "  claray explain scene.gltf --device gpu --size 1024x1024 --svg cost.svg\n"
        "  claray explain cornell --only mirror,glass --json");
    auto o = std::make_shared<ExplainOptions>();
    command->add_option("scene", o->scene, "A scene file, or a built-in scene (see claray scenes)")->required();
    add_size_option(*command, o->config.width, o->config.height, "WIDTHxHEIGHT in pixels [128x128]");
    add_view_options(*command, o->view);
    command->add_option("--max-depth", o->config.max_depth, "Surfaces per path, at most [128]")
        ->transform(whole_number(1, 1024));
    command->add_option("--rounds", o->measure.rounds, "Pairs of short renders to compare for each effect [7]")
        ->transform(whole_number(1, 1000));
    command->add_flag("!--no-compile-times", o->measure.compile_times, "Do not measure compile times");
    command->add_flag(
        "--unused", o->unused,
        "Also measure each effect that the scene does not use, compiled in: kernels for dozens of effects");
    command->add_option("--only", o->only, "Measure these effects and approximations only: NAME,NAME...");
    command->add_option("--effects", o->effects, "-NAME,-NAME... removes effects from the scene first");
    command->add_option("--svg", o->svg, "Write a bar chart");
    command->add_option("--device", o->device, "cpu, gpu, an index or part of a name (see claray devices)");
    add_bvh_options(*command, o->config.bvh);
    command->add_flag("--json", o->json, "Print as JSON");
    command->add_flag("-q,--quiet", o->quiet, "Print no progress");
    command->callback([&action, command, o] {
        refuse_both(*command, "--unused", {"--only"}, "--only may name unused effects");
        action = [o] { explain(*o); };
    });
}

}  // namespace claray::cli
