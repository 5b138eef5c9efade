// Denoised stills and frames of a renderer: the guides and the denoisers are kept while size and scene stay.
#pragma once

#include <optional>

#include "host/denoise/denoiser.hpp"
#include "host/render/guides.hpp"

namespace claray {

class DenoisingStage {
public:
    explicit DenoisingStage(const RenderConfig& config) : sampler_(config.sampler), added_(config.effects.add) {}

    struct Noisy {
        const SceneBuffers& scene;
        FrameData frame;
        const Buffer<FilmPixel>& film;
        std::uint32_t spp;
    };
    /// One guide per pixel, valid until the next call. Blocks.
    [[nodiscard]] const Buffer<Guide>& guides_of(const Noisy& noisy);
    /// Returns the radiance of the film, 3 floats per pixel, valid until the next call. Blocks.
    [[nodiscard]] const Buffer<float>& still(const Noisy& noisy);
    /// The same of a frame, with the light of the frames before. Blocks.
    [[nodiscard]] const Buffer<float>& next_frame(const Noisy& noisy);

    /// Follows a change of the scene. Light of earlier frames is used on if only the camera or objects moved.
    void follow(const SceneBuffers& scene, const SceneChanges& changes);
    /// Guides hold the buffers, the tree and the kernels of the scene: they are made again after these were replaced.
    void drop_guides() { guides_.reset(); }
    /// The film was cleared: until then, each frame replaces that of the call before.
    void start_film() { is_new_ = true; }
    /// Of the device.
    [[nodiscard]] std::uint64_t bytes() const;

private:
    Sampler sampler_;
    EffectSet added_;    // effects that kernels support in addition
    EffectSet effects_;  // for which the guides' kernels were compiled
    std::optional<Guides> guides_;
    std::optional<Denoiser> stills_;
    std::optional<FrameDenoiser> frames_;
    bool is_new_ = true;
};

}  // namespace claray
