#include "host/cli/output/verify_lines.hpp"

#include <cstdio>
#include <map>

#include "host/cli/output/table.hpp"

namespace claray::cli {

void print_head(const DeviceInfo& device) {
    std::printf("%s, driver %s\n%-18s %-64s %11s  %9s    %-8s %s\n", device.name.c_str(), device.driver.c_str(), "case",
                "figure", "tried", "worst", "bar", "unit");
    std::fflush(stdout);
}

void print_result(const VerifyResult& result) {
    for (const VerifyCheck& c : result.checks) {
        const bool first = &c == &result.checks.front();
        std::printf("%-18s %-64s %11llu  %9s <= %-8s %-22s %s%s\n", first ? result.name.c_str() : "", c.what.c_str(),
                    static_cast<unsigned long long>(c.tried), number(c.worst).c_str(), number(c.bar).c_str(),
                    c.unit.c_str(), c.holds() ? "holds" : "FAILS",
                    first ? (" " + fixed(result.seconds, 2) + " s").c_str() : "");
    }
    for (const auto& [name, value] : result.facts) std::printf("%-18s %s: %s\n", "", name.c_str(), value.c_str());
    if (!result.holds()) {
        for (const std::string& failure : result.failures) std::printf("  %s\n", failure.c_str());
        std::printf("  repeat: %s\n", result.command.c_str());
    }
    std::fflush(stdout);
}

namespace {
/// The cases that run each kernel.
std::map<std::string, std::string> cases_by_kernel(const std::vector<VerifyResult>& results) {
    std::map<std::string, std::string> cases;
    for (const std::string& kernel : kernel_names()) cases[kernel];
    for (const VerifyResult& result : results)
        for (const std::string& kernel : result.kernels)
            cases[kernel] += (cases[kernel].empty() ? "" : " ") + result.name;
    return cases;
}

}  // namespace

void print_kernels(const std::vector<VerifyResult>& results) {
    std::vector<Row> rows = {{"kernel", "cases"}};
    std::size_t run = 0;
    for (const auto& [kernel, cases] : cases_by_kernel(results)) {
        rows.push_back({kernel, cases.empty() ? "none" : cases});
        run += !cases.empty();
    }
    print_table(rows);
    std::printf("%zu of %zu kernels are run by a case\n", run, rows.size() - 1);
}

}  // namespace claray::cli
