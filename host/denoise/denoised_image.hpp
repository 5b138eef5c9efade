// Denoises a still by one of the denoisers.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>

#include "claray/renderer.hpp"
#include "claray/shared/denoise.h"
#include "claray/shared/path.h"

namespace claray {

struct NoisyFilm {
    std::uint32_t width, height;
    const Buffer<FilmPixel>& pixels;
    const Buffer<Guide>& guides;
    std::uint32_t spp;
    /// Copies an image of 3 floats per pixel to the host.
    std::function<void(const Buffer<float>&, std::span<glm::vec3>)> read;
};

/// Blocks. Throws as Renderer::denoised.
[[nodiscard]] std::vector<glm::vec3> denoised_image(const NoisyFilm& film, DenoiserKind kind);

}  // namespace claray
