// What users should know first about a scene.
#include <algorithm>
#include <cmath>

#include "host/accuracy/study.hpp"

namespace claray {
namespace {

constexpr double wanted_error = 0.01;

std::vector<StudyPoint> points_of(const std::vector<Study>& studies, const char* study, const char* method) {
    std::vector<StudyPoint> points;
    for (const Study& s : studies)
        if (s.name == study)
            std::copy_if(s.points.begin(), s.points.end(), std::back_inserter(points),
                         [&](const StudyPoint& p) { return p.method == method; });
    return points;
}

/// Seconds of a further sample, by a line through the last points: every render also takes a time that does not depend
/// on its samples, as for the start of kernels. 0 if the points do not tell: the time grows by less than a tenth.
double seconds_of_sample(const std::vector<StudyPoint>& points) {
    constexpr std::size_t most = 4;
    constexpr double least_growth = 1.1;
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, shortest = 0, longest = 0;
    for (auto p = points.rbegin(); p != points.rend() && n < most; ++p) {
        if (!p->failure.empty()) continue;
        const double x = p->value, y = p->seconds.median;
        n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
        shortest = y, longest = std::max(longest, y);
    }
    if (longest < least_growth * shortest) return 0;
    return std::max((n * sxy - sx * sy) / (n * sxx - sx * sx), 0.0);
}

/// Extrapolates the slope of the errors, limited to between that of independent samples and 1 / samples, and the time.
std::string samples_needed(const std::vector<StudyPoint>& points) {
    std::vector<double> samples, errors;
    for (const StudyPoint& p : points)
        if (p.failure.empty() && p.error.median > 0) samples.push_back(p.value), errors.push_back(p.error.median);
    if (samples.size() < 2) return {};
    const double slope = std::clamp(log_log_slope(samples, errors), -1.0, -0.5);
    const double needed = samples.back() * std::pow(wanted_error / errors.back(), 1 / slope);
    const double each = seconds_of_sample(points);
    const auto last =
        std::find_if(points.rbegin(), points.rend(), [](const StudyPoint& p) { return p.failure.empty(); });
    const double seconds = last->seconds.median, more = seconds + (needed - samples.back()) * each;
    return printed(
        "Samples: %g per pixel have an error of %.3g %% of the mean in %s; %g %% needs about %.0f samples%s.",
        samples.back(), 100 * errors.back(), duration_text(seconds).c_str(), 100 * wanted_error, needed,
        each > 0 && more > 0 ? (" and " + duration_text(more)).c_str() : "");
}

/// The least depth from which on the bias is small enough.
std::string depth_needed(const std::vector<StudyPoint>& points) {
    if (points.empty()) return {};
    const auto is_wrong = [](const StudyPoint& p) { return p.failure.empty() && p.error.median > wanted_error; };
    const auto last_wrong = std::find_if(points.rbegin(), points.rend(), is_wrong);
    if (last_wrong == points.rend())
        return printed("Depth: paths of %g surfaces contain at least 99 %% of the light.", points.front().value);
    const std::string wrong = printed("Depth: paths that end after %g surfaces have a bias of %.3g %% of the mean",
                                      last_wrong->value, 100 * last_wrong->error.median);
    if (last_wrong == points.rbegin()) return wrong + ".";
    return wrong + printed("; paths of %g surfaces are within 1 %%.", std::prev(last_wrong)->value);
}

/// The share of wrong pixels by format, at the ratio of planes that outdoor scenes have.
std::string depth_buffers_needed(const std::vector<Study>& studies) {
    constexpr double ratio = 1e4;
    std::string shares;
    for (const Study& s : studies)
        for (const StudyPoint& p : s.points)
            if (s.name == "depth" && p.value == ratio && p.failure.empty())
                shares += (shares.empty() ? " " : ", ") + p.method + printed(" %.3g %%", p.error.median);
    if (shares.empty()) return {};
    return printed("Depth buffers: pixels that show a wrong surface in some order of drawing, at far/near %g:", ratio) +
           shares + ".";
}

}  // namespace

std::vector<std::string> summary_of(const std::vector<Study>& studies) {
    std::vector<std::string> summary = {samples_needed(points_of(studies, "sampling", "Sobol")),
                                        depth_needed(points_of(studies, "bias", "path depth")),
                                        depth_buffers_needed(studies)};
    std::erase(summary, std::string());
    return summary;
}

}  // namespace claray
