// Colour curves that image writers share.
#pragma once

namespace claray {

/// Filmic tone curve from linear 0.. to linear 0..1: K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. NaN gives 0.
[[nodiscard]] float aces(float linear);

}  // namespace claray
