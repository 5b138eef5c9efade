#include "host/verify/reports.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <vector>

#include "host/base/format.hpp"
#include "host/base/message.hpp"

namespace claray::verify {
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

std::string in_quotes(const std::string& text) { return "\"" + escaped(text) + "\""; }

/// Values as JSON (RFC 8259). Texts come from drivers: bytes that are not UTF-8 are replaced.
std::string json(const std::string& text) {
    std::string out = "\"";
    for (const char c : many_lines(text))
        out += c == '\n'                 ? "\\n"
               : c == '\t'               ? "\\t"
               : (c == '"' || c == '\\') ? std::string("\\") + c
                                         : std::string(1, c);
    return out + '"';
}
std::string json(bool value) { return value ? "true" : "false"; }
std::string json(std::uint64_t value) { return std::to_string(value); }
/// The shortest decimal that gives the same double.
std::string json(double value) {
    if (!std::isfinite(value)) return "null";
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// Puts the elements between brackets, each on lines of its own. No line break is within a text.
std::string json_lines(char open, const std::vector<std::string>& elements, char close) {
    std::string out(1, open);
    for (const std::string& element : elements) {
        out += out.size() == 1 ? "\n  " : ",\n  ";
        for (const char c : element) out += c == '\n' ? "\n  " : std::string(1, c);
    }
    return out + (elements.empty() ? "" : "\n") + close;
}
template <class Values, class ToJson>
std::string json_array(const Values& values, const ToJson& to_json) {
    std::vector<std::string> elements;
    for (const auto& value : values) elements.push_back(to_json(value));
    return json_lines('[', elements, ']');
}
/// The second of each pair is JSON.
using Members = std::vector<std::pair<std::string, std::string>>;
std::string json_object(const Members& members) {
    std::vector<std::string> elements;
    for (const auto& [name, value] : members) elements.push_back(json(name) + ": " + value);
    return json_lines('{', elements, '}');
}

std::string json_of(const VerifyCheck& c) {
    return json_object({{"what", json(c.what)},
                        {"tried", json(c.tried)},
                        {"worst", json(c.worst)},
                        {"bar", json(c.bar)},
                        {"unit", json(c.unit)},
                        {"time", json(c.time)},
                        {"holds", json(c.holds())}});
}

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
    text += "<properties><property name=\"device\" value=" + in_quotes(device.name) +
            "/><property name=\"platform\" value=" + in_quotes(device.platform) +
            "/><property name=\"driver\" value=" + in_quotes(device.driver) + "/></properties>\n";
    for (const VerifyResult& result : results) {
        text +=
            printed("<testcase classname=\"verify\" name=\"%s\" time=\"%.3f\"", result.name.c_str(), result.seconds);
        if (result.holds()) {
            text += "/>\n";
            continue;
        }
        const std::vector<std::string> lines = reasons(result);
        text += "><failure message=" + in_quotes(lines[0]) + ">";
        for (const std::string& line : lines) text += escaped(line) + "\n";
        text += "</failure></testcase>\n";
    }
    return text + "</testsuite>\n";
}

std::string json_of(const VerifyResult& result, bool kernels) {
    const auto text = [](const std::string& value) { return json(value); };
    Members facts;
    for (const auto& [name, value] : result.facts) facts.emplace_back(name, json(value));
    Members members = {{"case", json(result.name)},
                       {"holds", json(result.holds())},
                       {"seconds", json(result.seconds)},
                       {"seed", json(result.seed)},
                       {"command", json(result.command)},
                       {"checks", json_array(result.checks, [](const VerifyCheck& c) { return json_of(c); })},
                       {"facts", json_object(facts)},
                       {"failures", json_array(result.failures, text)}};
    if (kernels) members.emplace_back("kernels", json_array(result.kernels, text));
    return json_object(members);
}

std::string json_of(const DeviceInfo& device, const VerifyOptions& options, std::span<const VerifyResult> results,
                    double seconds) {
    const bool holds = std::ranges::all_of(results, [](const VerifyResult& r) { return r.holds(); });
    const auto one = [&](const VerifyResult& result) { return json_of(result, options.kernels); };
    return json_object({{"device", json(device.name)},
                        {"platform", json(device.platform)},
                        {"driver", json(device.driver)},
                        {"effort", json(std::string(options.effort == Effort::full ? "full" : "quick"))},
                        {"seconds", json(seconds)},
                        {"holds", json(holds)},
                        {"cases", json_array(results, one)}}) +
           '\n';
}

}  // namespace claray::verify
