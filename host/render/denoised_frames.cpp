#include "host/render/denoised_frames.hpp"

#include <utility>

namespace claray {

DenoisedFrames::DenoisedFrames(const Device& device, const SceneBuffers& scene, const RenderConfig& config)
    : device_(device),
      sampler_(config.sampler),
      effects_(scene.effects),
      guides_(device, scene, sampler_),
      denoiser_(device, config.width, config.height) {}

const Buffer<float>& DenoisedFrames::next(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp) {
    const Buffer<Guide>& guides = guides_.trace(frame, film, spp);
    const bool continues = !std::exchange(is_new_, false);
    return denoiser_.denoise(frame.camera, film, guides, spp, continues);
}

/// Guides hold the buffers and the kernels of the scene.
void DenoisedFrames::follow(const SceneBuffers& scene, const SceneChanges& changes) {
    const bool shaded = changes.lights || changes.materials || changes.sky;
    if (shaded) denoiser_.forget();
    if (!shaded && !changes.instances && !changes.vertices && scene.effects == effects_) return;
    guides_ = Guides(device_, scene, sampler_), effects_ = scene.effects;
}

}  // namespace claray
