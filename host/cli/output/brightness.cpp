#include "host/cli/output/brightness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/percentile.hpp"
#include "host/lights/light_probe.hpp"
#include "host/lights/luminance.hpp"

namespace claray::cli {
namespace {

constexpr double medium = 0.5;

/// The exposure that shows a luminance as mid-grey.
std::string exposure_for(double luminance) {
    return "--exposure " + std::to_string(std::lround(std::log2(medium / luminance)));
}

/// How much brighter a surface would be if it were at least dark grey. What reflects nothing may shine itself.
double as_dark_grey(const glm::vec3& albedo) {
    constexpr double dark_grey = 0.18, nothing = 1e-4;
    const double reflected = luminance(albedo);
    return reflected > nothing && reflected < dark_grey ? dark_grey / reflected : 1;
}

}  // namespace

std::optional<std::string> brightness_warning(std::span<const glm::vec3> pixels, std::optional<float> exposure) {
    if (pixels.empty()) return {};
    std::vector<double> luminances;
    for (const glm::vec3& p : pixels) luminances.push_back(luminance(p));
    if (!(*std::max_element(luminances.begin(), luminances.end()) > 0))
        return "the image is black: no light reaches the visible surfaces; add light with --light or --sky, or move "
               "the camera";
    if (!exposure) return {};
    const double scale = std::exp2(double(*exposure)), bright = percentile(luminances, 0.99);
    if (bright * scale < visible_luminance && bright > 0)
        return "the image is nearly black; add light with --light or --sky, or brighten it with " +
               exposure_for(bright);
    if (bright * scale < visible_luminance)
        return "the image is nearly black; add light with --light or --sky, or move the camera";
    const double middle = percentile(luminances, 0.5);
    if (middle * scale > white_luminance) return "most of the image is white; darken it with " + exposure_for(middle);
    return {};
}

SurfaceBrightness::SurfaceBrightness(std::span<const glm::vec3> pixels, std::span<const float> depth, ToneMap tone_map,
                                     std::span<const glm::vec3> albedo) {
    std::vector<double> lit;
    double surfaces = 0, visible = 0, whites = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (!depth.empty() && !std::isfinite(depth[i])) continue;
        const double bright = luminance(pixels[i]);
        const double as_grey = bright * (albedo.empty() ? 1 : as_dark_grey(albedo[i]));
        surfaces += 1, visible += as_grey >= visible_luminance;
        whites += bright > (tone_map == ToneMap::aces ? white_luminance : 1);
        if (as_grey > 0 && std::isfinite(as_grey)) lit.push_back(as_grey);
    }
    if (lit.empty()) return;
    visible_ = visible / surfaces, white_ = whites / double(lit.size());
    lighter_ = percentile(lit, 0.75);
}

bool SurfaceBrightness::is_doubtful() const {
    constexpr double a_part = 0.02, most = 0.5;
    return lighter_ > 0 && (white_ >= a_part || visible_ < most);
}

const char* SurfaceBrightness::fault() const {
    constexpr double half = 0.5;
    if (white_ >= half && exposure() < 0) return "white";
    return is_mostly_black() && exposure() > 0 ? "black" : nullptr;
}

float SurfaceBrightness::exposure() const {
    return lighter_ > 0 ? float(std::round(10 * std::log2(medium / lighter_)) / 10) : 0.f;
}

}  // namespace claray::cli
