// Rays of one kind on the device, and room for what they find.
#pragma once

#include "claray/query.hpp"

namespace claray::measure {

struct DeviceRays {
    std::string name;  ///< "primary", "shadow", "bounce", "random"
    bool any_hit;      ///< asked whether they hit, not what
    Buffer<Ray> rays;
    Buffer<Hit> hits;
    Buffer<std::uint8_t> occluded;

    DeviceRays(const Device& device, std::string kind, bool any, const std::vector<Ray>& of);

    void trace(const Bvh& bvh);
    /// What the last trace found, as bytes to compare.
    [[nodiscard]] std::string results() const;
};

/// All kinds of rays of a scene (see three_views, make_rays), or those recorded beside a .scn file.
[[nodiscard]] std::vector<DeviceRays> upload_rays(const Device& device, const std::string& scene,
                                                  const std::vector<Mesh>& meshes, unsigned width, unsigned height);

}  // namespace claray::measure
