// The lights of a scene as one distribution by power.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

struct Lights {
    std::vector<TriangleLight> triangles;
    std::vector<PointLightData> points;
    float density = 0;  ///< FrameData::light_density

    [[nodiscard]] std::size_t size() const { return triangles.size() + points.size(); }
};

/// Emissive triangles that can be hit, and point lights, each picked in proportion to its radiant power: 2 pi times
/// area times the luminance of its radiance (both sides emit), or 4 pi times the luminance of its intensity.
[[nodiscard]] Lights collect_lights(const Scene& scene);

}  // namespace claray
