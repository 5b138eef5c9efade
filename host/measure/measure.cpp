#include "host/measure/measure.hpp"

#include <algorithm>
#include <ctime>
#include <limits>

namespace claray::measure {
namespace {

double quantile(std::vector<double>& values, double share) {
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Returns milliseconds of all threads.
double run_task(const Device& device, const std::function<void()>& task) {
    device.finish();
    device.profiler().reset();
    const std::clock_t begin = std::clock();
    task();
    device.finish();
    return 1e3 * double(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// Adds the commands since the profiler's last reset.
void add_round(Profiler& profiler, Timing& timing, std::map<std::string, std::vector<double>>& commands) {
    double sum = 0;
    std::uint64_t begin = std::numeric_limits<std::uint64_t>::max(), end = 0;
    for (const auto& [name, summary] : profiler.summary()) {
        commands[name].push_back(summary.milliseconds);
        sum += summary.milliseconds;
        begin = std::min(begin, summary.start);
        end = std::max(end, summary.end);
    }
    timing.rounds.push_back(sum);
    timing.spans.push_back(end > begin ? double(end - begin) * 1e-6 : 0);
}

}  // namespace

double median(std::vector<double> values) { return values.empty() ? 0 : quantile(values, 0.5); }

double relative_spread(const std::vector<double>& values) {
    if (values.empty()) return 0;
    std::vector<double> sorted = values;
    const double middle = quantile(sorted, 0.5);
    return middle > 0 ? 0.5 * (quantile(sorted, 0.75) - quantile(sorted, 0.25)) / middle : 0;
}

std::vector<Timing> measure_rounds(const Device& device, int rounds, const std::vector<std::function<void()>>& tasks) {
    std::vector<Timing> timings(tasks.size());
    std::vector<std::map<std::string, std::vector<double>>> commands(tasks.size());
    for (int round = -1; round < rounds; ++round)
        for (std::size_t i = 0; i < tasks.size(); ++i) {
            const double processor = run_task(device, tasks[i]);
            if (round < 0) continue;
            add_round(device.profiler(), timings[i], commands[i]);
            timings[i].processor.push_back(processor);
        }
    for (std::size_t i = 0; i < tasks.size(); ++i)
        for (const auto& [name, values] : commands[i]) {
            timings[i].commands[name] = median(values);
            timings[i].least[name] = *std::min_element(values.begin(), values.end());
        }
    return timings;
}

std::map<std::string, double> measure(const Device& device, int repeat, const std::function<void()>& task) {
    const Timing timing = measure_rounds(device, repeat, {task})[0];
    std::map<std::string, double> medians = timing.commands;
    medians[""] = timing.milliseconds();
    return medians;
}

}  // namespace claray::measure
