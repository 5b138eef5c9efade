#include "host/verify/probes/reduce.hpp"

#include <algorithm>

#include "host/base/file.hpp"
#include "host/verify/probes/probes.hpp"

namespace claray::verify {
namespace {

/// Also if the fault is known, as a reduction shows it to others.
bool shows_fault(const VerifyResult& result) {
    return !std::all_of(result.checks.begin(), result.checks.end(), [](const VerifyCheck& c) { return c.is_met(); });
}

using Say = std::function<void(const std::string&)>;

std::vector<std::string> failing(const std::vector<std::string>& names, const RunCases& run, const Say& say) {
    std::vector<std::string> found;
    run(names, [&](const VerifyResult& result) {
        if (!shows_fault(result)) return;
        found.push_back(result.name);
        std::string why = result.failures.empty() ? "" : result.failures.front();
        if (why.empty() && !result.facts.empty()) why = result.facts.back().second;  // a known fault
        say(result.name + " fails" + (why.empty() ? "" : ": " + why));
    });
    return found;
}

}  // namespace

std::vector<std::string> probes_to_write(const std::vector<std::string>& names, const RunCases& run, const Say& say) {
    std::vector<std::string> probes, others;
    for (const std::string& name : names) (is_probe(name) ? probes : others).push_back(name);
    const bool all = names.empty() || (!others.empty() && !failing(others, run, say).empty());
    if (!all && probes.empty()) say("none of these cases fails: there is nothing to reduce");
    if (!all) return probes;
    const std::vector<std::string> found = failing(probe_names(), run, say);
    if (found.empty()) say("no probe fails: the fault cannot be shown without claray");
    for (const std::string& name : found)
        if (std::find(probes.begin(), probes.end(), name) == probes.end()) probes.push_back(name);
    return probes;
}

std::string write_probe(const std::filesystem::path& folder, const std::string& name) {
    const ProbeTexts texts = probe_texts(name);
    make_folder(folder);
    write_file(folder / (name + ".cl"), texts.kernel);
    write_file(folder / (name + ".c"), texts.program);
    return "cd " + folder.string() + " && cc " + name + ".c -lOpenCL -o " + name + " && ./" + name;
}

}  // namespace claray::verify
