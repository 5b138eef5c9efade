// Whether reported errors are true: the same images against a second, larger reference.
#include <algorithm>
#include <cmath>

#include "host/accuracy/study.hpp"

namespace claray {

ErrorCheck check_errors(const Device& device, const Scene& scene, const StudyOptions& options,
                        const AccuracyProgress& progress) {
    constexpr unsigned larger = 16;
    const double share = 1.0 / (1 + larger);
    ErrorCheck check;
    check.reported = study_sampling(device, scene, options, scaled(progress, 0, share));
    StudyOptions again = options;
    again.reference_factor = larger * options.reference_factor;
    again.reference_seed = options.reference_seed ^ 0x40000000u;
    check.independent = study_sampling(device, scene, again, scaled(progress, share, 1));
    std::vector<double> samples, errors;
    for (std::size_t i = 0; i < check.reported.points.size(); ++i) {
        const StudyPoint &a = check.reported.points[i], &b = check.independent.points[i];
        if (!a.failure.empty() || !b.failure.empty()) continue;
        const double off = std::fabs(a.error.median / b.error.median - 1);
        check.points += 1, check.within += off <= 0.1;
        check.worst = std::max(check.worst, off);
        if (a.method == "independent") samples.push_back(a.value), errors.push_back(a.error.median);
    }
    check.slope = log_log_slope(samples, errors);
    return check;
}

}  // namespace claray
