// A scene's shading data in device memory.
#pragma once

#include "claray/shared/path.h"
#include "host/effects/effects.hpp"
#include "host/render/structure.hpp"
#include "host/textures/textures.hpp"

namespace claray {

struct SceneBuffers {
    /// Uploads what the scene calls for. `added`: effects that kernels are to have in any case.
    SceneBuffers(const Device& device, const Scene& scene, const Structure& structure, EffectSet added = {});

    Structure structure;           // whose positions and indices are shared
    Buffer<std::uint32_t> tables;  // all in one, since kernels take few arguments
    SceneTables where{};           // in `tables`
    Textures textures;
    LightsData lights{};  // lights.count: of those that shadow rays are sent to
    EffectSet effects;    // of the scene

    /// Binds SCENE_PARAMETERS of shade/scene.clh.
    void bind(Kernel& kernel, unsigned& index) const;
    [[nodiscard]] std::uint64_t bytes() const;
};

}  // namespace claray
