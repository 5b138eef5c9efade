// The random numbers of rays, the same on every machine.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "claray/shared/types.h"

namespace claray::measure {

/// A generator of 32-bit numbers: PCG (O'Neill 2014).
class Pcg {
public:
    std::uint32_t next() {
        state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
        const auto word = std::uint32_t(((state_ >> 18) ^ state_) >> 27);
        const auto turn = std::uint32_t(state_ >> 59);
        return (word >> turn) | (word << ((32 - turn) & 31));
    }
    float uniform() { return float(next() >> 8) * 0x1p-24f; }

private:
    std::uint64_t state_ = 1;
};

/// All of both, in random order.
[[nodiscard]] inline std::vector<Ray> shuffled(std::vector<Ray> rays, const std::vector<Ray>& more, Pcg& random) {
    rays.insert(rays.end(), more.begin(), more.end());
    for (std::size_t i = rays.size(); i > 1; --i) std::swap(rays[i - 1], rays[random.next() % i]);
    return rays;
}

}  // namespace claray::measure
