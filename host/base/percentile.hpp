// Percentiles of measured values.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace claray {

/// Returns the least value that at least `share` of the values do not exceed (nearest rank). `values` is not empty, and
/// 0 < share <= 1.
[[nodiscard]] inline double percentile(std::vector<double> values, double share) {
    const auto rank = std::ptrdiff_t(std::ceil(share * double(values.size()))) - 1;
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[std::size_t(rank)];
}

}  // namespace claray
