// Denoises a still by Open Image Denoise.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "claray/shared/denoise.h"
#include "claray/shared/path.h"

namespace claray {

struct NoisyFilm {
    unsigned width, height;
    std::vector<FilmPixel> pixels;
    std::vector<Guide> guides;
};

/// Throws as Renderer::denoised.
[[nodiscard]] std::vector<glm::vec3> denoised_by_oidn(const NoisyFilm& film);

}  // namespace claray
