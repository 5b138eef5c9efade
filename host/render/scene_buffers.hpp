// A scene's shading data in device memory.
#pragma once

#include "claray/bvh.hpp"
#include "host/render/effects.hpp"
#include "host/render/textures.hpp"

namespace claray {

struct SceneBuffers {
    /// Uploads what the scene calls for.
    SceneBuffers(const Device& device, const Scene& scene, const Bvh& bvh);

    Bvh bvh;                // whose positions and indices are shared
    Buffer<float> normals;  // per vertex; not allocated where no mesh has any
    Buffer<std::uint32_t> triangle_materials;
    Buffer<MaterialData> materials;
    Buffer<TriangleLight> triangle_lights;
    Buffer<PointLightData> point_lights;
    Textures textures;
    std::uint32_t lights = 0;  // triangles and points
    float light_density = 0;   // FrameData::light_density
    EffectSet effects;         // of the scene

    /// Binds SCENE_PARAMETERS of render/shade_surface.cl.
    void bind(Kernel& kernel, unsigned& index) const;
    [[nodiscard]] std::uint64_t bytes() const;
};

}  // namespace claray
