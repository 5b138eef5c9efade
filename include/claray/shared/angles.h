// Angles in half turns, for code that host and kernels share. In kernels they have the same bits on every device.
#ifndef CLARAY_SHARED_ANGLES_H
#define CLARAY_SHARED_ANGLES_H

#ifdef __OPENCL_C_VERSION__

#include "math/vector.clh"

static inline float claray_half_turns(float y, float x) { return half_turns_of(y, x); }
static inline float claray_cosine(float half_turns) {
    const float turns = 0.5f * half_turns;
    return cosine_and_sine(turns - floor(turns)).x;
}
static inline float claray_sine(float half_turns) {
    const float turns = 0.5f * half_turns;
    return cosine_and_sine(turns - floor(turns)).y;
}

#else

#include <cmath>
#include <numbers>

namespace claray {

/// The angle of (x, y) from the x axis, -1 to 1.
inline double claray_half_turns(double y, double x) { return std::atan2(y, x) / std::numbers::pi; }
inline double claray_cosine(double half_turns) { return std::cos(std::numbers::pi * half_turns); }
inline double claray_sine(double half_turns) { return std::sin(std::numbers::pi * half_turns); }

}  // namespace claray

#endif

#endif
