#include "host/cli/render_targets.hpp"

#include <cmath>
#include <cstdio>

namespace claray::cli {
namespace {

constexpr unsigned most_spp = 1u << 24;

void refuse_both(const CLI::App& command, const char* one, std::initializer_list<const char*> others, const char* why) {
    if (command.count(one) == 0) return;
    for (const char* other : others)
        if (command.count(other) > 0)
            throw Error(ErrorKind::usage, std::string(one) + " and " + other + " contradict each other: " + why,
                        "leave one of them out");
}

CLI::AsNumberWithUnit time_units() {
    return CLI::AsNumberWithUnit(
        std::map<std::string, double>{{"us", 1e-6}, {"ms", 1e-3}, {"s", 1}, {"m", 60}, {"min", 60}, {"h", 3600}});
}

}  // namespace

CLI::Validator number_above(const std::string& range, float least, bool included) {
    const auto check = [range, least, included](const std::string& text) {
        float value = NAN;
        const bool ok = CLI::detail::lexical_cast(text, value) && std::isfinite(value) &&
                        (value > least || (included && value == least));
        return ok ? std::string() : "'" + text + "' is not a number of " + range;
    };
    return CLI::Validator(check, "");
}

void add_target_options(CLI::App& command, RenderOptions& o) {
    command
        .add_option("--error", o.config.error,
                    "Take as many samples as this RMSE over the mean needs: 0.01, for instance")
        ->check(number_above("more than 0", 0.f, false));
    command.add_option("--time", o.config.seconds, "Take as many samples as fit into this time: 500ms, 2s, 1m")
        ->transform(time_units())
        ->check(number_above("more than 0", 0.f, false));
}

void check_targets(const CLI::App& command, RenderOptions& o) {
    refuse_both(command, "--error", {"--spp", "--noise"}, "the error says how many samples are taken");
    const bool until_target = o.config.error > 0 || o.config.seconds > 0;
    if (until_target && command.count("--spp") == 0) o.config.spp = most_spp;
    o.picks_settings = until_target && command.count("--spp") == 0;
    o.picks_builder = command.count("--builder") == 0;
}

void print_picks(const TargetPlan& plan) {
    for (const std::string& pick : plan.picks) std::printf("%s\n", pick.c_str());
}

void refuse_missed_error(const RenderConfig& config, const RenderProgress& reached) {
    if (!(config.error > 0) || (reached.error_bound > 0 && reached.error_bound <= config.error)) return;
    char text[240];
    const double ratio = reached.error_bound / config.error;
    if (reached.error_bound > 0)
        std::snprintf(text, sizeof text,
                      "the error is %.3g, not the %g asked for; that needs about %.0f samples a pixel and %.3g s",
                      reached.error_bound, config.error, reached.spp * ratio * ratio, reached.seconds * ratio * ratio);
    else
        std::snprintf(text, sizeof text, "the error of %g asked for was not reached: %u samples a pixel tell nothing",
                      config.error, reached.spp);
    throw Error(ErrorKind::user, text);
}

}  // namespace claray::cli
