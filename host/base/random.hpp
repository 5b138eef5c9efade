// Random numbers for built-in scenes: the same on every compiler and library, which std distributions are not.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace claray::scenes {

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): every input bit reaches every output bit.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// SplitMix64.
class Random {
public:
    explicit constexpr Random(std::uint64_t seed) : state_(mix(seed + 1)) {}

    [[nodiscard]] constexpr std::uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15u); }
    /// In [0, 1), a multiple of 2^-24.
    [[nodiscard]] constexpr float uniform() { return float(bits() >> 40) * 0x1p-24f; }
    [[nodiscard]] constexpr float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
    /// In [0, count).
    [[nodiscard]] constexpr std::uint32_t below(std::uint32_t count) {
        return std::uint32_t(((bits() >> 32) * count) >> 32);
    }
    /// In the cube [-1, 1)^3.
    [[nodiscard]] glm::vec3 in_cube() {
        const float x = uniform(-1.f, 1.f), y = uniform(-1.f, 1.f), z = uniform(-1.f, 1.f);
        return {x, y, z};
    }
    /// In the unit ball, by rejection: no function of the mathematics library, which would differ between systems.
    [[nodiscard]] glm::vec3 in_ball() {
        for (;;)
            if (const glm::vec3 p = in_cube(); glm::dot(p, p) <= 1.f) return p;
    }

private:
    std::uint64_t state_;
};

}  // namespace claray::scenes
