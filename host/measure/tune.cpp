#include "host/measure/tune.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <sstream>

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/compute/programs/kernel_sources.hpp"
#include "host/compute/tuning.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {
namespace {

/// A scene to measure. Its rays are made once: some start at hits, which do not depend on tuning.
struct Subject {
    std::string name;
    std::vector<Mesh> meshes;
    std::vector<DeviceRays> rays;
};

/// The tasks that measure one value, and their expected results.
struct Work {
    std::vector<std::function<void()>> tasks;
    std::string results;
};

bool wants(const TuningCandidates& of, const char* work) {
    return std::find(of.work.begin(), of.work.end(), work) != of.work.end();
}

void add_build(const Device& device, const Subject& subject, Builder builder, Work& work) {
    const auto bvh = std::make_shared<Bvh>(Bvh::build(device, subject.meshes, {.builder = builder}));
    work.results += bvh->hash();
    work.tasks.emplace_back([bvh] { bvh->rebuild(); });
}

void add_rays(const Device& device, Subject& subject, bool closest, bool any, Work& work) {
    const auto bvh = std::make_shared<Bvh>(Bvh::build(device, subject.meshes, {.learns = false}));
    for (DeviceRays& rays : subject.rays) {
        if (!(rays.any_hit ? any : closest)) continue;
        rays.trace(*bvh);
        work.results += rays.results();
        work.tasks.emplace_back([bvh, &rays] { rays.trace(*bvh); });
    }
}

/// The task includes the creation of the renderer.
void add_render(const Device& device, const Subject& subject, const TuneOptions& options, Work& work) {
    if (subject.name.ends_with(".scn")) return;  // no materials
    Warnings warnings;
    const auto scene = std::make_shared<Scene>(load_scene(subject.name, warnings));
    const RenderConfig config{.width = 2 * options.width, .height = 2 * options.height, .spp = 4};
    work.tasks.emplace_back([device, scene, config] {
        Renderer renderer(device, *scene, config);
        (void)renderer.render();
    });
}

Work prepare(const Device& device, const TuneOptions& options, const TuningCandidates& of,
             std::vector<Subject>& subjects) {
    Work work;
    const bool closest = wants(of, "rays") || wants(of, "closest"), any = wants(of, "rays") || wants(of, "any");
    for (Subject& subject : subjects) {
        if (wants(of, "fast")) add_build(device, subject, Builder::fast, work);
        if (wants(of, "balanced")) add_build(device, subject, Builder::balanced, work);
        if (closest || any) add_rays(device, subject, closest, any, work);
        if (wants(of, "render")) add_render(device, subject, options, work);
    }
    return work;
}

/// Per round the geometric mean of the tasks' times, times their number: long tasks weigh no more than short ones.
std::vector<double> combine(const std::vector<Timing>& timings, std::size_t begin, std::size_t count) {
    if (count == 0) return {};
    std::vector<double> combined(timings[begin].spans.size(), 0);
    for (std::size_t round = 0; round < combined.size(); ++round) {
        for (std::size_t i = 0; i < count; ++i)
            combined[round] += std::log(std::max(timings[begin + i].spans[round], 1e-9));
        combined[round] = double(count) * std::exp(combined[round] / double(count));
    }
    return combined;
}

/// Times several values in alternating runs.
std::vector<std::vector<double>> race(const Device& device, const TuningCandidates& of, int repeat,
                                      const std::vector<std::pair<unsigned, const Work*>>& values) {
    std::vector<std::function<void()>> tasks;
    for (const auto& [value, work] : values)
        for (const auto& task : work->tasks)
            tasks.emplace_back([&device, &of, value = value, &task] {
                device.set_tuning(of.kernel, of.parameter, value);
                task();
            });
    const std::vector<Timing> timings = measure_rounds(device, repeat, tasks);
    std::vector<std::vector<double>> times;
    std::size_t begin = 0;
    for (const auto& [value, work] : values) {
        times.push_back(combine(timings, begin, work->tasks.size()));
        begin += work->tasks.size();
    }
    return times;
}

/// Tries the values of one parameter and sets the best.
std::vector<Trial> tune_parameter(const Device& device, const TuneOptions& options, const TuningCandidates& of,
                                  std::vector<Subject>& subjects) {
    const unsigned in_force = device.tuning(of.kernel, of.parameter);
    std::vector<unsigned> values = {in_force};
    for (const unsigned value : of.values)
        if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);

    std::vector<Trial> trials;
    std::vector<std::unique_ptr<Work>> works;
    std::vector<std::pair<unsigned, const Work*>> runners;
    std::vector<std::size_t> trial_of;  // a runner's
    for (const unsigned value : values) {
        Trial trial;
        trial.kernel = of.kernel, trial.parameter = of.parameter;
        trial.value = value, trial.in_force = value == in_force;
        try {
            device.set_tuning(of.kernel, of.parameter, value);
            works.push_back(std::make_unique<Work>(prepare(device, options, of, subjects)));
            for (const auto& task : works.back()->tasks) task();
            device.finish();
            if (works.back()->results != works[0]->results) trial.failure = "gives different results";
        } catch (const Error& error) {
            if (trial.in_force) throw;  // the current value must work
            trial.failure = std::string(error.what(), std::strcspn(error.what(), "\n"));
        }
        if (trial.failure.empty()) {
            runners.emplace_back(value, works.back().get());
            trial_of.push_back(trials.size());
        }
        trials.push_back(trial);
    }

    const auto times = race(device, of, options.repeat, runners);
    std::size_t best = 0;
    double best_ratio = 1;
    for (std::size_t i = 0; i < runners.size(); ++i) {
        Trial& trial = trials[trial_of[i]];
        const PairedRatio paired = paired_ratio(times[i], times[0]);
        trial.milliseconds = median(times[i]);
        trial.ratio = paired.ratio, trial.noise = paired.noise;
        if (paired.faster() && paired.ratio < best_ratio) best = i, best_ratio = paired.ratio;
    }
    if (best != 0) {  // the best of many may be so by chance: measure it again, alone
        const auto again = race(device, of, options.repeat, {runners[0], runners[best]});
        const PairedRatio paired = paired_ratio(again[1], again[0]);
        Trial& trial = trials[trial_of[best]];
        trial.ratio = std::max(trial.ratio, paired.ratio), trial.noise = std::max(trial.noise, paired.noise);
        trial.kept = paired.faster();
        if (!trial.kept) best = 0;
    }
    device.set_tuning(of.kernel, of.parameter, runners[best].first);
    return trials;
}

/// The device's name as a pattern of the tuning table, in which blanks separate words.
std::string pattern_of(const DeviceInfo& info) {
    std::string pattern = info.name;
    for (char& c : pattern)
        if (std::isspace(static_cast<unsigned char>(c)) || c == '#') c = '_';
    return pattern;
}

}  // namespace

std::vector<TuningCandidates> parse_candidates(const std::string& text, const std::string& name,
                                               const DeviceInfo& info) {
    static const std::vector<std::string> works = {"fast", "balanced", "rays", "closest", "any", "render"};
    std::vector<TuningCandidates> all;
    std::istringstream lines(text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::istringstream row(line.substr(0, line.find('#')));
        std::string pattern, work;
        TuningCandidates candidates;
        if (!(row >> pattern)) continue;
        bool good = bool(row >> candidates.kernel >> candidates.parameter >> work);
        std::istringstream parts(work);
        for (std::string part; std::getline(parts, part, '+');) {
            good = good && std::find(works.begin(), works.end(), part) != works.end();
            candidates.work.push_back(part);
        }
        for (long long value = -1; row >> value;) {
            good = good && value >= 0 && value <= 0xffffffffLL;
            candidates.values.push_back(unsigned(value));
        }
        if (!good || !row.eof() || candidates.values.empty())
            throw Error(ErrorKind::user,
                        name + ":" + std::to_string(number) + ": not a row of candidates: '" + line + "'",
                        "write: device-pattern kernel PARAMETER work value value ...");
        if (!pattern_matches(pattern, info)) continue;
        const auto same = std::find_if(all.begin(), all.end(), [&](const TuningCandidates& other) {
            return other.kernel == candidates.kernel && other.parameter == candidates.parameter;
        });
        if (same == all.end())
            all.push_back(candidates);
        else
            *same = candidates;
    }
    return all;
}

std::vector<TuningCandidates> candidates_for(const DeviceInfo& info) {
    return parse_candidates(kernel_source("tuning_candidates.txt").text, "tuning_candidates.txt", info);
}

PairedRatio paired_ratio(const std::vector<double>& times, const std::vector<double>& base) {
    std::vector<double> ratios, deviations;
    for (std::size_t i = 0; i < std::min(times.size(), base.size()); ++i)
        if (base[i] > 0) ratios.push_back(times[i] / base[i]);
    if (ratios.empty()) return {};
    const double middle = median(ratios);
    for (const double ratio : ratios) deviations.push_back(std::fabs(ratio - middle));
    return {middle, 1.2533 * 1.4826 * median(deviations) / std::sqrt(double(ratios.size()))};
}

std::vector<TunedRow> tune(const Device& device, const TuneOptions& options,
                           const std::vector<TuningCandidates>& candidates,
                           const std::function<void(const std::vector<Trial>&)>& on_trials) {
    std::vector<Subject> subjects;
    for (const std::string& name : options.scenes) {
        Subject subject{name, load_meshes(name), {}};
        subject.rays = upload_rays(device, name, subject.meshes, options.width, options.height);
        subjects.push_back(std::move(subject));
    }
    std::vector<TunedRow> rows;
    for (const TuningCandidates& of : candidates) {
        const std::string name = of.kernel + " " + of.parameter;
        if (name.find(options.only) == std::string::npos) continue;
        const bool only_value = of.values.size() == 1 && of.values[0] == device.tuning(of.kernel, of.parameter);
        if (only_value) continue;
        const std::vector<Trial> trials = tune_parameter(device, options, of, subjects);
        for (const Trial& trial : trials)
            if (trial.kept) rows.push_back({trial.kernel, trial.parameter, trial.value, trial.ratio});
        on_trials(trials);
    }
    return rows;
}

std::string with_rows(const std::string& table, const DeviceInfo& info, const std::vector<TunedRow>& rows) {
    const std::string pattern = pattern_of(info);
    std::istringstream lines(table);
    std::string text, line;
    while (std::getline(lines, line)) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string of, kernel, parameter;
        words >> of >> kernel >> parameter;
        const bool replaced = of == pattern && std::any_of(rows.begin(), rows.end(), [&](const TunedRow& row) {
                                  return row.kernel == kernel && row.parameter == parameter;
                              });
        if (!replaced) text += line + "\n";
    }
    for (const TunedRow& row : rows) {
        const std::string saved = row.measured ? "measured" : printed("%.1f %% less time", 100 * (1 - row.ratio));
        text += pattern + "  " + row.kernel + "  " + row.parameter + "  " + std::to_string(row.value) +
                "  # claray tune: " + saved + "\n";
    }
    return text;
}

}  // namespace claray::measure
