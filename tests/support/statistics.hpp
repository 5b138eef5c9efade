// Tests of hypotheses.
#pragma once

#include <cmath>
#include <vector>

namespace claray::test {

/// The value that chi-squared of this many degrees of freedom exceeds with a probability of 1 % (Wilson and Hilferty
/// 1931).
inline double chi_squared_limit(double degrees) {
    const double spread = 2 / (9 * degrees), z = 2.3263478740;
    return degrees * std::pow(1 - spread + z * std::sqrt(spread), 3);
}

struct ChiSquared {
    double value = 0, degrees = -1;
    [[nodiscard]] bool plausible() const { return value < chi_squared_limit(degrees); }
};

/// Counts against expected ones with the same sum; bins are joined until 5 are expected.
inline ChiSquared chi_squared(const std::vector<double>& observed, const std::vector<double>& expected) {
    ChiSquared result;
    double seen = 0, awaited = 0;
    const auto close_bin = [&] {
        result.value += (seen - awaited) * (seen - awaited) / awaited;
        ++result.degrees;
        seen = awaited = 0;
    };
    for (std::size_t i = 0; i < observed.size(); ++i) {
        seen += observed[i], awaited += expected[i];
        if (awaited >= 5) close_bin();
    }
    if (awaited > 0.5) close_bin();
    return result;
}

}  // namespace claray::test
