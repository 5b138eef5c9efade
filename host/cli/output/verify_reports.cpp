#include "host/cli/output/verify_reports.hpp"

#include <algorithm>
#include <vector>

#include "host/accuracy/svg.hpp"
#include "host/base/format.hpp"

namespace claray::cli {
namespace {

/// The figures above their limits, the failures, and the command that repeats the case.
std::vector<std::string> reasons(const VerifyResult& result) {
    std::vector<std::string> lines;
    for (const VerifyCheck& c : result.checks)
        if (!c.holds()) lines.push_back(printed("%s: %g > %g %s", c.what.c_str(), c.worst, c.bar, c.unit.c_str()));
    lines.insert(lines.end(), result.failures.begin(), result.failures.end());
    lines.push_back("repeat: " + result.command);
    return lines;
}

std::string quoted(const std::string& text) { return "\"" + svg::escaped(text) + "\""; }

}  // namespace

std::string tap_of(std::span<const VerifyResult> results) {
    std::string text = printed("TAP version 14\n1..%zu\n", results.size());
    for (std::size_t i = 0; i < results.size(); ++i) {
        const VerifyResult& result = results[i];
        text += printed("%s %zu - %s\n", result.holds() ? "ok" : "not ok", i + 1, result.name.c_str());
        if (result.holds()) continue;
        text += "  ---\n  reasons: |\n";
        for (const std::string& line : reasons(result)) text += "    " + line + "\n";
        text += "  ...\n";
    }
    return text;
}

std::string junit_of(const DeviceInfo& device, std::span<const VerifyResult> results) {
    const auto failures = std::ranges::count_if(results, [](const VerifyResult& r) { return !r.holds(); });
    double seconds = 0;
    for (const VerifyResult& result : results) seconds += result.seconds;
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    text += printed("<testsuite name=\"claray verify\" tests=\"%zu\" failures=\"%td\" time=\"%.3f\">\n", results.size(),
                    failures, seconds);
    text += "<properties><property name=\"device\" value=" + quoted(device.name) +
            "/><property name=\"platform\" value=" + quoted(device.platform) +
            "/><property name=\"driver\" value=" + quoted(device.driver) + "/></properties>\n";
    for (const VerifyResult& result : results) {
        text +=
            printed("<testcase classname=\"verify\" name=\"%s\" time=\"%.3f\"", result.name.c_str(), result.seconds);
        if (result.holds()) {
            text += "/>\n";
            continue;
        }
        const std::vector<std::string> lines = reasons(result);
        text += "><failure message=" + quoted(lines[0]) + ">";
        for (const std::string& line : lines) text += svg::escaped(line) + "\n";
        text += "</failure></testcase>\n";
    }
    return text + "</testsuite>\n";
}

}  // namespace claray::cli
