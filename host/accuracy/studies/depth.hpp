// The surfaces at the centres of pixels, as a rasteriser meets them.
#pragma once

#include "claray/query.hpp"
#include "host/accuracy/study.hpp"

namespace claray {

struct DepthFragment {
    std::uint32_t pixel = 0, triangle = 0;
    double z = 0;  ///< distance along the view
};

/// All surfaces on the rays through the pixels' centres, in float64, by pixel and in the order of the triangles.
/// Cut-outs count as solid.
[[nodiscard]] std::vector<DepthFragment> rasterised(const Camera& camera, std::span<const Mesh> meshes,
                                                    std::span<const Ray> rays, unsigned width, unsigned height);

}  // namespace claray
