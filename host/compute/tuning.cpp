#include "host/compute/tuning.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "host/compute/kernel_sources.hpp"

namespace claray {
namespace {

/// '*' any device; "cpu", "gpu": its type; otherwise a part of the device's name.
bool pattern_matches(const std::string& pattern, const DeviceInfo& info) {
    return pattern == "*" || pattern == to_string(info.type) || info.name.find(pattern) != std::string::npos;
}

}  // namespace

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
    if (const char* local = std::getenv("CLARAY_TUNING"); local != nullptr && *local != '\0') {
        std::ifstream file(local);
        if (!file) throw Error(ErrorKind::user, std::string("CLARAY_TUNING: cannot read ") + local);
        std::ostringstream text;
        text << file.rdbuf();
        apply_tuning(text.str(), local, info, values);
    }
    return values;
}

}  // namespace claray
