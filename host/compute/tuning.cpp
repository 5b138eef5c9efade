#include "host/compute/tuning.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <optional>
#include <sstream>

#include "claray/device.hpp"
#include "host/base/file.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {
bool pattern_matches(const std::string& pattern, const DeviceInfo& info) {
    if (pattern == "*" || pattern == to_string(info.type)) return true;
    const auto same = [](char in_name, char in_pattern) { return in_pattern == '_' || in_pattern == in_name; };
    return std::search(info.name.begin(), info.name.end(), pattern.begin(), pattern.end(), same) != info.name.end();
}

std::filesystem::path local_tuning_path() {
    const std::filesystem::path file = std::filesystem::path("claray") / "tuning.txt";
    if (const char* xdg = std::getenv("XDG_CONFIG_HOME"); xdg != nullptr && *xdg) return xdg / file;
    if (const char* home = std::getenv("HOME"); home != nullptr && *home)
        return std::filesystem::path(home) / ".config" / file;
    return {};
}

bool TuningRange::holds(unsigned value) const {
    return value >= least && value <= most && (!powers || (value & (value - 1)) == 0);
}

std::string TuningRange::text() const {
    if (least == most) return "only " + std::to_string(least) + " works";
    return std::string(powers ? "choose a power of two in " : "choose a value in ") + std::to_string(least) + ".." +
           std::to_string(most);
}

namespace {

constexpr std::size_t most_warnings = 10;  // per table

struct TuningRow {
    int line = 0;
    std::string name;  // kernel and parameter
    std::optional<unsigned> value;
    std::optional<TuningRange> range;
};

std::optional<unsigned> number_in(const std::string& text) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// least..most, or least..mostx2
std::optional<TuningRange> range_in(std::string text) {
    TuningRange range;
    range.powers = text.ends_with("x2");
    if (range.powers) text.resize(text.size() - 2);
    const std::size_t dots = text.find("..");
    if (dots == std::string::npos) return {};
    const std::optional<unsigned> least = number_in(text.substr(0, dots)), most = number_in(text.substr(dots + 2));
    if (!least || !most || *least > *most) return {};
    range.least = *least, range.most = *most;
    return range;
}

/// Calls `use` for each row that matches the device. Only claray's own table has ranges.
void for_each_row(const std::string& text, const std::string& name, const DeviceInfo& info, bool with_ranges,
                  const std::function<void(const TuningRow&)>& use) {
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string pattern, kernel, parameter, value, range, rest;
        if (!(words >> pattern)) continue;
        words >> kernel >> parameter >> value >> range >> rest;
        const TuningRow row = {number, kernel + " " + parameter, number_in(value), range_in(range)};
        const bool good = row.value || (value == "-" && row.range);
        if (!good || (with_ranges ? !range.empty() && !row.range : !range.empty()) || !rest.empty())
            throw Error(ErrorKind::user, name + ":" + std::to_string(number) + ": not a tuning row: '" + line + "'",
                        "write: device-pattern kernel PARAMETER value");
        if (pattern_matches(pattern, info)) use(row);
    }
}

}  // namespace

void apply_tuning(const std::string& text, const std::string& name, const DeviceInfo& info, Tuning& tuning) {
    for_each_row(text, name, info, true, [&](const TuningRow& row) {
        if (row.value) tuning.values[row.name] = *row.value;
        if (row.range) tuning.ranges[row.name] = *row.range;
    });
}

void apply_users_tuning(const std::string& text, const std::string& name, const DeviceInfo& info, Tuning& tuning) {
    std::size_t ignored = 0;
    const auto ignore = [&](const TuningRow& row, const std::string& why) {
        if (++ignored > most_warnings) return;
        tuning.warnings.push_back(name + ":" + std::to_string(row.line) + ": ignored: '" + row.name + "' " + why);
    };
    for_each_row(text, name, info, false, [&](const TuningRow& row) {
        const auto range = tuning.ranges.find(row.name);
        if (range == tuning.ranges.end())
            ignore(
                row,
                "is not a tuning parameter of this device; remove the line (kernels/tuning.txt lists the parameters)");
        else if (!range->second.holds(*row.value))
            ignore(row, "cannot be " + std::to_string(*row.value) + "; " + range->second.text());
        else
            tuning.values[row.name] = *row.value;
    });
    if (ignored > most_warnings)
        tuning.warnings.push_back(name + ": " + std::to_string(ignored - most_warnings) +
                                  " more rows are ignored; remove the file, or write it again with 'claray tune'");
}

Tuning tuning_for(const DeviceInfo& info) {
    Tuning tuning;
    apply_tuning(kernel_source("tuning.txt").text, "tuning.txt", info, tuning);
    const std::filesystem::path users = local_tuning_path();
    std::error_code unreadable;
    if (!users.empty() && std::filesystem::exists(users, unreadable))
        apply_users_tuning(read_file(users, "check its permissions"), users.string(), info, tuning);
    if (const char* local = std::getenv("CLARAY_TUNING"); local != nullptr && *local != '\0')
        apply_users_tuning(read_file(local, "set CLARAY_TUNING to a tuning table, or unset it"), local, info, tuning);
    return tuning;
}

std::vector<std::string> tuning_warnings(const Device& device) { return state_of(device).tuning_warnings; }

Defines with_tuning(const Device& device, const std::string& stem, Defines defines) {
    const std::string prefix = stem + " ";
    Defines tuned;
    for (const auto& [name, value] : state_of(device).tuning) {
        if (!name.starts_with(prefix)) continue;
        const std::string parameter = name.substr(prefix.size());
        const bool given = std::any_of(defines.begin(), defines.end(), [&](auto& d) { return d.first == parameter; });
        if (!given) tuned.emplace_back(parameter, std::to_string(value));
    }
    defines.insert(defines.end(), tuned.begin(), tuned.end());
    return defines;
}

}  // namespace claray
