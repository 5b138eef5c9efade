#include "host/render/denoising_stage.hpp"

#include <utility>

namespace claray {

const Buffer<Guide>& DenoisingStage::guides_of(const Noisy& noisy) {
    if (!guides_) {
        effects_ = noisy.scene.effects;
        guides_.emplace(noisy.film.device(), noisy.scene, effects_ | added_, sampler_);
    }
    return guides_->trace(noisy.frame, noisy.film, noisy.spp);
}

const Buffer<float>& DenoisingStage::still(const Noisy& noisy) {
    const Buffer<Guide>& guides = guides_of(noisy);
    if (!stills_) stills_.emplace(noisy.film.device(), noisy.frame.width, noisy.frame.height);
    return stills_->denoise(noisy.film, guides, noisy.spp);
}

const Buffer<float>& DenoisingStage::next_frame(const Noisy& noisy) {
    const Buffer<Guide>& guides = guides_of(noisy);
    if (!frames_) frames_.emplace(noisy.film.device(), noisy.frame.width, noisy.frame.height);
    const bool continues = !std::exchange(is_new_, false);
    return frames_->denoise(noisy.frame.camera, noisy.film, guides, noisy.spp, continues);
}

void DenoisingStage::follow(const SceneBuffers& scene, const SceneChanges& changes) {
    const bool shaded = changes.lights || changes.materials || changes.sky;
    if (shaded && frames_) frames_->forget();
    if (shaded || changes.instances || changes.vertices || scene.effects != effects_) drop_guides();
}

std::uint64_t DenoisingStage::bytes() const {
    return (guides_ ? guides_->bytes() : 0) + (stills_ ? stills_->bytes() : 0) + (frames_ ? frames_->bytes() : 0);
}

}  // namespace claray
