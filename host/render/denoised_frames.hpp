// Frames without most of their noise: the guides and the history of a renderer whose scene changes.
#pragma once

#include "host/denoise/denoiser.hpp"
#include "host/render/guides.hpp"

namespace claray {

class DenoisedFrames {
public:
    DenoisedFrames(const Device& device, const SceneBuffers& scene, const RenderConfig& config);

    /// Returns the radiance of the film, 3 floats per pixel, valid until the next call. Blocks.
    [[nodiscard]] const Buffer<float>& next(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp);
    /// Follows a change of the scene. Light of earlier frames is used on if only the camera or objects moved.
    void follow(const SceneBuffers& scene, const SceneChanges& changes);
    /// The film was cleared: until then, each call replaces the frame of the call before.
    void start_film() { is_new_ = true; }

private:
    Device device_;
    Sampler sampler_;
    EffectSet effects_;  // for which the guides' kernels were compiled
    Guides guides_;
    FrameDenoiser denoiser_;
    bool is_new_ = true;
};

}  // namespace claray
