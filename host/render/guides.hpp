// Guides of the denoiser: traces the camera rays of a film again and keeps what they meet first.
#pragma once

#include <vector>

#include "claray/renderer.hpp"
#include "claray/shared/denoise.h"
#include "host/render/scene_buffers.hpp"

namespace claray {

class Guides {
public:
    /// `effects`: those that the kernels have code for.
    Guides(const Device& device, const SceneBuffers& scene, EffectSet effects, Sampler sampler);

    /// One guide per pixel of the frame, for a film of `spp` samples per pixel. Blocks.
    [[nodiscard]] const Buffer<Guide>& trace(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp);
    /// Of the device, besides those of the scene.
    [[nodiscard]] std::uint64_t bytes() const;

private:
    /// Traces further rays of the pixels with the most noise: `wanted_rays`, or `most_rays` if so few are too few for
    /// any of them. Returns their number.
    [[nodiscard]] double trace_edges(const FrameData& frame, const Buffer<FilmPixel>& film, double wanted_rays,
                                     double most_rays, std::uint32_t spp);
    struct Run {
        std::uint32_t pixels, samples;  // of each
    };
    /// Traces consecutive pixels of the image, or of the list.
    void trace_runs(const FrameData& frame, const Buffer<FilmPixel>& film, const std::vector<Run>& runs,
                    std::uint32_t first_pixel, bool listed);

    [[nodiscard]] Range range_of_writing(std::uint32_t pixels, bool listed) const;
    void make_room(std::size_t rays);
    /// Follows the camera rays of a batch to the first rough surface. Blocks.
    void see(GuideStep guide);

    Device device_;
    SceneBuffers scene_;
    std::uint32_t capacity_, bounces_per_look_;
    Kernel start_, see_, write_, find_edges_, list_edges_;
    SceneQuery query_;
    Buffer<Ray> rays_[2];  // by depth
    Buffer<float> times_[2];
    Buffer<std::uint32_t> numbers_[2];     // the camera ray of each from depth 1 on
    Buffer<std::uint32_t> ray_counts_[3];  // how many rays there are, of this depth, the next and the one after
    SceneHits hits_;
    Buffer<Sight> sights_;
    Buffer<std::uint8_t> classes_;
    Buffer<GuideRun> runs_;  // of the present batch
    Buffer<std::uint32_t> list_, counts_, ends_;
    Buffer<Guide> guides_;
    Buffer<Glow> glows_;
};

}  // namespace claray
