// What studies have in common.
#pragma once

#include <cstdio>

#include "claray/accuracy.hpp"

namespace claray {

/// Names of all `StudyPoint::facts`, in the order in which they first appear.
[[nodiscard]] std::vector<std::string> fact_names(const Study& study);
/// NaN where the point has none of that name.
[[nodiscard]] double fact_of(const StudyPoint& point, const std::string& name);

/// std::snprintf into a string.
template <class... Values>
[[nodiscard]] std::string told(const char* format, Values... values) {
    char text[240];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

/// Progress of a part that is from `from` to `to` of the whole.
[[nodiscard]] AccuracyProgress scaled(const AccuracyProgress& progress, double from, double to);

}  // namespace claray
