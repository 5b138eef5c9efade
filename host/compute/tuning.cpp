#include "host/compute/tuning.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "host/compute/device_state.hpp"
#include "host/compute/file.hpp"
#include "host/compute/kernel_sources.hpp"

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

void apply_tuning(const std::string& text, const std::string& name, const DeviceInfo& info,
                  std::map<std::string, unsigned>& values) {
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::istringstream row(line.substr(0, line.find('#')));
        std::string pattern, kernel, parameter, rest;
        long long value = -1;
        if (!(row >> pattern)) continue;
        if (!(row >> kernel >> parameter >> value) || value < 0 || value > 0xffffffffLL || (row >> rest))
            throw Error(ErrorKind::user, name + ":" + std::to_string(number) + ": not a tuning row: '" + line + "'",
                        "write: device-pattern kernel PARAMETER value");
        if (pattern_matches(pattern, info)) values[kernel + " " + parameter] = unsigned(value);
    }
}

std::map<std::string, unsigned> tuning_for(const DeviceInfo& info) {
    std::map<std::string, unsigned> values;
    apply_tuning(kernel_source("tuning.txt").text, "tuning.txt", info, values);
    const std::filesystem::path users = local_tuning_path();
    std::error_code unreadable;
    if (!users.empty() && std::filesystem::exists(users, unreadable))
        apply_tuning(read_file(users, "check its permissions"), users.string(), info, values);
    if (const char* local = std::getenv("CLARAY_TUNING"); local != nullptr && *local != '\0')
        apply_tuning(read_file(local, "CLARAY_TUNING names it: set it to a tuning table, or unset it"), local, info,
                     values);
    return values;
}

Defines with_tuning(const Device& device, const std::string& stem, Defines defines) {
    const std::string prefix = stem + " ";
    Defines tuned;
    for (const auto& [name, value] : device.state().tuning) {
        if (!name.starts_with(prefix)) continue;
        const std::string parameter = name.substr(prefix.size());
        const bool given = std::any_of(defines.begin(), defines.end(), [&](auto& d) { return d.first == parameter; });
        if (!given) tuned.emplace_back(parameter, std::to_string(value));
    }
    defines.insert(defines.end(), tuned.begin(), tuned.end());
    return defines;
}

}  // namespace claray
