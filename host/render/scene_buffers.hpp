// A scene's shading data in device memory.
#pragma once

#include "host/effects/effects.hpp"
#include "host/render/structure.hpp"
#include "host/textures/textures.hpp"

namespace claray {

struct SceneBuffers {
    /// Uploads what the scene calls for. `added`: effects that kernels are to have in any case.
    SceneBuffers(const Device& device, const Scene& scene, const Structure& structure, EffectSet added = {});

    Structure structure;    // whose positions and indices are shared
    Buffer<float> normals;  // per vertex; not allocated where no mesh has any
    Buffer<std::uint32_t> triangle_materials;
    Buffer<MaterialData> materials;
    Buffer<float> energy_tables;  // not allocated where no material needs them
    Buffer<TriangleLight> triangle_lights;
    Buffer<PunctualLight> punctual_lights;
    Buffer<LightNode> light_tree;
    Buffer<LightLeaf> light_leaves;
    Buffer<LightTrail> light_trails;
    Buffer<HotSpot> hot_spots;    // not allocated where no point light is close to a surface
    Buffer<std::uint32_t> lamps;  // not allocated where no image is on a lamp
    Buffer<float> environment_texels, environment_cdf;
    Textures textures;
    LightsData lights{};  // lights.count: of those that shadow rays are sent to
    EffectSet effects;    // of the scene

    /// Binds SCENE_PARAMETERS of render/shade_surface.cl.
    void bind(Kernel& kernel, unsigned& index) const;
    [[nodiscard]] std::uint64_t bytes() const;
};

}  // namespace claray
