// The G-buffer at pixel centres: deferred/write_gbuffer.cl.
#pragma once

#include "claray/renderer.hpp"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {

class GBufferStage {
public:
    /// Loads the kernels for these effects, and a buffer for `pixels` pixels at a time.
    GBufferStage(const SceneBuffers& scene, EffectSet effects, std::uint32_t pixels);

    /// Traces all pixels and packs their surfaces. Blocks. `far`: see GBuffer.
    [[nodiscard]] GBuffer run(Wavefront& wavefront, NormalPacking packing, float far);
    [[nodiscard]] std::uint64_t bytes() const { return pixels_.bytes(); }

private:
    SceneQuery trace_;
    Kernel write_;
    Buffer<GBufferPixel> pixels_;
};

}  // namespace claray
