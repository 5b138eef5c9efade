// Warnings about black and white images.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <glm/glm.hpp>

namespace claray::cli {

/// A warning, with a remedy, if nearly all pixels are black or white at this exposure. Without an exposure, as for
/// files that store the radiance, only if all are black.
[[nodiscard]] std::optional<std::string> brightness_warning(std::span<const glm::vec3> pixels,
                                                            std::optional<float> exposure);

}  // namespace claray::cli
