// Functions that studies share.
#pragma once

#include "claray/accuracy.hpp"
#include "host/base/format.hpp"

namespace claray {

/// Columns of tables: names of all `StudyPoint::facts`, in the order in which they first appear. A study without facts
/// has further measures of images: "relMSE" and "perceptual".
[[nodiscard]] std::vector<std::string> fact_names(const Study& study);
/// NaN if the point has no fact of that name, or the measure is 0.
[[nodiscard]] double fact_of(const StudyPoint& point, const std::string& name);

/// The last point of a method that did not fail; null if there is none.
[[nodiscard]] const StudyPoint* last_of(const Study& study, const std::string& method);

/// Quartiles and median of `values` times `factor`.
[[nodiscard]] Spread spread_of(std::vector<double> values, double factor);
/// Whether the ranges between the quartiles overlap: then the runs do not show which is larger.
[[nodiscard]] bool overlap(const Spread& a, const Spread& b);
/// "in 0.53 of the time", or that the quartiles overlap.
[[nodiscard]] std::string told_time_against(const Spread& seconds, const Spread& others);

/// Which point is fastest by the number of rays, where `seconds` is paid once and `error` is the time of 10^6 rays: the
/// lower envelope of the lines.
[[nodiscard]] std::string told_crossings(const std::vector<StudyPoint>& points);

/// Progress of a part of the work, from the fraction `from` to the fraction `to` of the whole.
[[nodiscard]] AccuracyProgress scaled(const AccuracyProgress& progress, double from, double to);

/// How many samples an error of 1 % needs, from the study `sampling`, and how many surfaces per path, from the study
/// `bias`. Studies that were not run have no line.
[[nodiscard]] std::vector<std::string> summary_of(const std::vector<Study>& studies);

}  // namespace claray
