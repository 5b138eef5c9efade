// Data of the surfaces at pixel centres: render/write_aovs.cl.
#pragma once

#include "claray/renderer.hpp"
#include "host/compute/memory.hpp"
#include "host/render/wavefront.hpp"

namespace claray {

/// Of kernels that describe the surfaces at pixel centres.
[[nodiscard]] Defines defines_of_aovs(const SceneBuffers& scene, EffectSet effects);

class AovStage {
public:
    /// Loads the kernels for these effects, and buffers for `pixels` pixels at a time.
    AovStage(const SceneBuffers& scene, EffectSet effects, std::uint32_t pixels);

    [[nodiscard]] std::uint32_t capacity() const { return std::uint32_t(depth.size()); }
    /// Traces pixels `first` to `first` + `count` - 1, at most `capacity()`; asynchronous. The data of pixel `first` +
    /// i is element i.
    void run(Wavefront& wavefront, const SceneBuffers& scene, std::uint32_t first, std::uint32_t count);

    [[nodiscard]] std::uint64_t bytes() const {
        return buffer_bytes(depth, normal, albedo, primitive, visits, counts_);
    }

    Buffer<float> depth, normal, albedo;  ///< 1, 3 and 3 per pixel, as in Aovs
    Buffer<std::uint32_t> primitive, visits;

private:
    Buffer<Visits> counts_;
    SceneQuery trace_;
    Kernel write_;
};

}  // namespace claray
