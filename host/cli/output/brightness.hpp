// Whether a picture shows anything.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <glm/glm.hpp>

namespace claray::cli {

/// What to tell the user of pixels that are nearly all black or white at an exposure, and what to do; nothing where
/// they are neither. Without an exposure, as for files that hold the radiance, only pixels that are all black count.
[[nodiscard]] std::optional<std::string> brightness_warning(std::span<const glm::vec3> pixels,
                                                            std::optional<float> exposure);

}  // namespace claray::cli
