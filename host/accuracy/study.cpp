// Functions that studies share: statistics of repeated runs, the front, slopes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/accuracy/study.hpp"

namespace claray {

std::vector<std::string> fact_names(const Study& study) {
    std::vector<std::string> names;
    for (const StudyPoint& p : study.points)
        for (const auto& [name, value] : p.facts)
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names.empty() ? std::vector<std::string>{"relMSE", "perceptual"} : names;
}

double fact_of(const StudyPoint& point, const std::string& name) {
    for (const auto& [known, value] : point.facts)
        if (known == name) return value;
    const double error = name == "relMSE" ? point.errors.relmse : name == "perceptual" ? point.errors.perceptual : 0;
    return error > 0 ? error : std::nan("");
}

const StudyPoint* last_of(const Study& study, const std::string& method) {
    const auto last = std::find_if(study.points.rbegin(), study.points.rend(),
                                   [&](const StudyPoint& p) { return p.method == method && p.failure.empty(); });
    return last == study.points.rend() ? nullptr : &*last;
}

AccuracyProgress scaled(const AccuracyProgress& progress, double from, double to) {
    if (!progress) return {};
    return [=](double done, const std::string& what) { return progress(from + (to - from) * done, what); };
}

Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double part) {
        const double place = part * double(values.size() - 1);
        const std::size_t below = std::size_t(place);
        const double next = values[std::min(below + 1, values.size() - 1)];
        return values[below] + (place - double(below)) * (next - values[below]);
    };
    return {at(0.25), at(0.5), at(0.75)};
}

Spread spread_of(std::vector<double> values, double factor) {
    for (double& value : values) value *= factor;
    return spread_of(std::move(values));
}

bool overlap(const Spread& a, const Spread& b) { return a.low <= b.high && b.low <= a.high; }

std::string told_time_against(const Spread& seconds, const Spread& others) {
    if (overlap(seconds, others)) return "in about the same time (the quartiles overlap)";
    return printed("in %.2f of the time", seconds.median / others.median);
}

std::string told_crossings(const std::vector<StudyPoint>& points) {
    const auto name_of = [](const StudyPoint& p) { return p.method + ", " + p.setting; };
    const StudyPoint* best = nullptr;
    for (const StudyPoint& p : points)
        if (p.failure.empty() && (!best || p.seconds.median < best->seconds.median)) best = &p;
    if (!best) return "no tree was built";
    std::string text = "including the build, " + name_of(*best) + " is fastest";
    for (;;) {
        const StudyPoint* next = nullptr;
        double at = std::numeric_limits<double>::infinity();
        for (const StudyPoint& p : points) {
            if (!p.failure.empty() || p.error.high >= best->error.low) continue;
            const double crossing = (p.seconds.median - best->seconds.median) / (best->error.median - p.error.median);
            if (crossing < at) at = crossing, next = &p;
        }
        if (!next) return text;
        text += printed("; from %.3g million rays on, ", std::max(at, 0.0)) + name_of(*next);
        best = next;
    }
}

void mark_front(std::vector<StudyPoint>& points) {
    for (StudyPoint& p : points) {
        p.front = p.failure.empty();
        for (const StudyPoint& q : points)
            if (q.failure.empty() && q.error.median <= p.error.median && q.seconds.median <= p.seconds.median &&
                (q.error.median < p.error.median || q.seconds.median < p.seconds.median))
                p.front = false;
    }
}

double log_log_slope(std::span<const double> x, std::span<const double> y) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        if (!(x[i] > 0 && y[i] > 0)) continue;
        const double a = std::log(x[i]), b = std::log(y[i]);
        n += 1, sx += a, sy += b, sxx += a * a, sxy += a * b;
    }
    const double spread = n * sxx - sx * sx;
    return n < 2 || spread <= 0 ? 0 : (n * sxy - sx * sy) / spread;
}

}  // namespace claray
