// A scene's shading data in device memory.
#pragma once

#include "claray/shared/path.h"
#include "host/effects/effects.hpp"
#include "host/render/structure.hpp"
#include "host/textures/textures.hpp"

namespace claray {

struct SceneBuffers {
    /// Uploads the data that the scene needs. `added`: effects that kernels support in addition.
    SceneBuffers(const Device& device, const Scene& scene, const Structure& structure, EffectSet added = {});

    Structure structure;           // shares its positions and indices
    Buffer<std::uint32_t> tables;  // all in one buffer, so that kernels have few arguments
    SceneTables where{};           // offsets in `tables`
    Textures textures;
    LightsData lights{};  // lights.count: number of lights for shadow rays
    EffectSet effects;    // of the scene

    /// Binds SCENE_PARAMETERS of shade/scene.clh.
    void bind(Kernel& kernel, unsigned& index) const;
    [[nodiscard]] std::uint64_t bytes() const;
};

}  // namespace claray
