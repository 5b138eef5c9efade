// Spherical harmonics of directions.
#include "claray/shared/spherical_harmonics.h"

/// Nine numbers per direction (three numbers).
kernel void harmonics_of_directions(uint count, global const float* directions, global float* values) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 d = vload3(i, directions);
    float of_direction[CLARAY_HARMONICS];
    claray_harmonics(d.x, d.y, d.z, of_direction);
    for (uint k = 0; k < CLARAY_HARMONICS; ++k) values[CLARAY_HARMONICS * i + k] = of_direction[k];
}
