// What studies have in common.
#pragma once

#include "claray/accuracy.hpp"
#include "host/base/format.hpp"

namespace claray {

/// Names of all `StudyPoint::facts`, in the order in which they first appear.
[[nodiscard]] std::vector<std::string> fact_names(const Study& study);
/// NaN where the point has none of that name.
[[nodiscard]] double fact_of(const StudyPoint& point, const std::string& name);

/// Whether what is between the quartiles of one is partly between those of the other: then runs don't tell which is
/// more.
[[nodiscard]] bool overlap(const Spread& a, const Spread& b);
/// "in 0.53 of the time", or that the runs don't tell.
[[nodiscard]] std::string told_time_against(const Spread& seconds, const Spread& others);

/// "0.53 s", "2.1 min", "3.4 h", "12 days"
[[nodiscard]] std::string told_time(double seconds);

/// Progress of a part that is from `from` to `to` of the whole.
[[nodiscard]] AccuracyProgress scaled(const AccuracyProgress& progress, double from, double to);

}  // namespace claray
