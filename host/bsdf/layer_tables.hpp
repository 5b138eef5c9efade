// Energy tables of the layers over a base: sheen and a clear coat.
#pragma once

namespace claray {

/// From CLARAY_SHEEN to CLARAY_STRETCH.
void fill_sheen(float* tables, double);
/// From CLARAY_COAT_SCALES to CLARAY_STRETCHED_UNREFLECTED, for a coat of this index of refraction.
void fill_coat(float* scales, double ior);

}  // namespace claray
