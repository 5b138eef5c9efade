// Real spherical harmonics of the bands 0 to 2, for light that changes slowly with the direction: Ramamoorthi and
// Hanrahan 2001, "An efficient representation for irradiance environment maps".
#ifndef CLARAY_SHARED_SPHERICAL_HARMONICS_H
#define CLARAY_SHARED_SPHERICAL_HARMONICS_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

#define CLARAY_HARMONICS 9u  // of the bands 0 to 2; the first 4 are those of the bands 0 and 1

/// The values of the harmonics in a direction of unit length, for scalars and vectors of scalars. They are orthonormal
/// over the sphere.
#define CLARAY_FIND_HARMONICS(x, y, z, values)                                                      \
    values[0] = (x)*0.0f + 0.282094792f;                                                            \
    values[1] = 0.488602512f * (y), values[2] = 0.488602512f * (z), values[3] = 0.488602512f * (x); \
    values[4] = 1.092548431f * (x) * (y), values[5] = 1.092548431f * (y) * (z);                     \
    values[6] = 0.315391565f * (3.0f * (z) * (z)-1.0f);                                             \
    values[7] = 1.092548431f * (x) * (z), values[8] = 0.546274215f * ((x) * (x) - (y) * (y))
CLARAY_SHARED_FUNCTION void claray_harmonics(float x, float y, float z, float* values) {
    CLARAY_FIND_HARMONICS(x, y, z, values);
}

/// Factor of harmonic i that turns radiance into irradiance over pi: the clamped cosine in that band.
CLARAY_SHARED_FUNCTION float claray_harmonic_of_cosine(uint i) {
    return i == 0u ? 1.0f : i < 4u ? 0.666666667f : 0.25f;
}

CLARAY_SHARED_END

#endif
