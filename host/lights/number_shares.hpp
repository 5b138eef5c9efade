// Assigns ranges of 32-bit random numbers to lights.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace claray {

/// Assigns 2^32 numbers in proportion to power, at least one to each light, so that rounding loses none.
class NumberShares {
public:
    struct Share {
        std::uint32_t first, last;  // of the light's numbers
        float probability;
    };
    NumberShares(double total_power, std::size_t lights) : total_(total_power), left_(lights) {}

    Share next(double power) {
        --left_;
        sum_ += power;
        const double range = 4294967296.0;
        const auto ideal = std::uint64_t(std::clamp(std::round(sum_ / total_ * range), 0.0, range));
        const std::uint64_t end =
            left_ == 0 ? std::uint64_t(range) : std::clamp(ideal, begin_ + 1, std::uint64_t(range) - left_);
        const Share share = {std::uint32_t(begin_), std::uint32_t(end - 1), float(double(end - begin_) / range)};
        begin_ = end;
        return share;
    }

private:
    double total_, sum_ = 0;
    std::size_t left_;
    std::uint64_t begin_ = 0;
};

}  // namespace claray
