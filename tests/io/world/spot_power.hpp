// The light of a spot, in parts of its intensity: sums over the angles of its cone.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "claray/scene.hpp"

namespace claray::test {

/// `falloff`: what is left of the intensity at an angle from the axis.
template <class Falloff>
double power_between(double outer_angle, const Falloff& falloff) {
    constexpr int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double angle = (i + 0.5) * outer_angle / steps;
        sum += falloff(angle) * 2 * std::numbers::pi * std::sin(angle) * outer_angle / steps;
    }
    return sum;
}

/// By KHR_lights_punctual.
inline double power_of_spot(const Light& light) {
    const double inner = std::cos(double(light.inner_angle)), outer = std::cos(double(light.outer_angle));
    return power_between(light.outer_angle, [&](double angle) {
        const double t = std::min(1.0, (std::cos(angle) - outer) / (inner - outer));
        return t * t;
    });
}

}  // namespace claray::test
