// Why two libraries find different hits of round curves, decided in float64.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "claray/shared/types.h"

namespace claray::measure {

/// Uniform cubic B-splines; those of a strand follow each other.
struct Strands {
    std::vector<glm::vec4> points;
    std::vector<std::uint32_t> segments;
};

/// Who finds what float64 finds of the hull of balls along the exact curves.
struct Right {
    std::size_t both = 0, claray = 0, embree = 0, neither = 0;
};

/// Numbers of rays whose hits differ, each in one class: the first that applies.
struct Differences {
    std::size_t begin_inside = 0;  ///< the ray begins inside a curve, of which claray finds entries only
    std::size_t at_ends = 0;       ///< the end of a strand: a ball for claray, open for Embree
    std::size_t near = 0;  ///< the same hit, no more than a 32nd of a radius in front of the exact one or behind it
    Right graze;           ///< a 32nd of a radius decides whether the ray meets a curve
    Right others;
};

/// `claray` and `embree` are distances of the first hits, infinite where there is none.
[[nodiscard]] Differences explain(const Strands& strands, std::span<const Ray> rays, std::span<const float> claray,
                                  std::span<const float> embree);

/// Whether two distances are those of different hits.
[[nodiscard]] bool differ(float a, float b);

}  // namespace claray::measure
