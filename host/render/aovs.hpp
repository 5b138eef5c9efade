// Data of the surfaces at pixel centres: render/write_aovs.cl.
#pragma once

#include "claray/renderer.hpp"
#include "host/compute/memory.hpp"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// What kernels write of an AOV whose pixels have this type: floats or whole numbers.
template <class Pixel>
using AovWord = std::conditional_t<std::is_same_v<Pixel, std::uint32_t>, std::uint32_t, float>;

/// Of kernels that describe the surfaces at pixel centres.
[[nodiscard]] Defines defines_of_aovs(const SceneBuffers& scene, EffectSet effects);

class AovStage {
public:
    /// Loads the kernels for these effects, and buffers for `pixels` pixels at a time. `uvs`: of all vertices, or
    /// empty.
    AovStage(const SceneBuffers& scene, EffectSet effects, std::uint32_t pixels, const std::vector<glm::vec2>& uvs);

    [[nodiscard]] std::uint32_t capacity() const { return std::uint32_t(counts_.size()); }
    /// Traces a batch of at most `capacity()` pixels, one sample each; asynchronous. The data of its pixel i is element
    /// i.
    void run(Wavefront& wavefront, const Batch& batch);

    [[nodiscard]] std::uint64_t bytes() const {
#define CLARAY_BUFFER(name, kind, letters, meaning) , name
        return buffer_bytes(counts_, uvs_ CLARAY_AOVS(CLARAY_BUFFER));
#undef CLARAY_BUFFER
    }

    // The AOVs' words, as in Aovs.
#define CLARAY_BUFFER(name, kind, letters, meaning) Buffer<AovWord<aov_kinds::kind>> name;
    CLARAY_AOVS(CLARAY_BUFFER)
#undef CLARAY_BUFFER

private:
    Buffer<Visits> counts_;
    Buffer<float> uvs_;
    SceneQuery trace_;
    Kernel write_;
};

}  // namespace claray
