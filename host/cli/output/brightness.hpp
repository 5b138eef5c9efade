// Warnings about black and white images, and exposures that avoid them.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <glm/glm.hpp>

#include "claray/image/picture.hpp"

namespace claray::cli {

inline constexpr double white_luminance = 4;  ///< the filmic curve shows 98 % from here on

/// A warning, with a remedy, if nearly all pixels are black or white at this exposure. Without an exposure, as for
/// files that store the radiance, only if all are black.
[[nodiscard]] std::optional<std::string> brightness_warning(std::span<const glm::vec3> pixels,
                                                            std::optional<float> exposure);

/// How bright the surfaces of a picture are at exposure 0.
class SurfaceBrightness {
public:
    /// `depth` is infinite where a pixel shows no surface; empty: all pixels count. With `albedo`, surfaces that are
    /// dark count as dark grey ones in their place: in enough light, they are to look dark.
    explicit SurfaceBrightness(std::span<const glm::vec3> pixels, std::span<const float> depth = {},
                               ToneMap tone_map = ToneMap::aces, std::span<const glm::vec3> albedo = {});

    /// Whether `fault` could find one if it knew where surfaces are.
    [[nodiscard]] bool is_doubtful() const;
    /// "white" or "black" if most surfaces are that and another exposure shows more of them; null: neither.
    [[nodiscard]] const char* fault() const;
    /// The exposure that shows the lighter surfaces in a medium brightness, in tenths of stops; 0 if all are black.
    [[nodiscard]] float exposure() const;

private:
    [[nodiscard]] bool is_mostly_black() const { return visible_ < 0.1; }

    double white_ = 0;    // share of the lit surfaces that the tone map shows as white
    double visible_ = 0;  // share of the surfaces that are light enough to be seen
    double lighter_ = 0;  // luminance that three quarters of the lit surfaces do not exceed
};

}  // namespace claray::cli
