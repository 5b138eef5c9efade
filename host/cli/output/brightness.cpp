#include "host/cli/output/brightness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/lights/light_probe.hpp"

namespace claray::cli {
namespace {

constexpr double white = 4;  // the filmic curve shows 98 % from here on

/// The luminance that a share of the pixels does not exceed.
double quantile(std::vector<double>& luminances, double share) {
    const auto at = luminances.begin() + std::ptrdiff_t(share * double(luminances.size() - 1));
    std::nth_element(luminances.begin(), at, luminances.end());
    return *at;
}

/// The exposure that shows a luminance as mid-grey.
std::string exposure_for(double luminance) {
    return "--exposure " + std::to_string(std::lround(-std::log2(2 * luminance)));
}

}  // namespace

std::optional<std::string> brightness_warning(std::span<const glm::vec3> pixels, std::optional<float> exposure) {
    if (pixels.empty()) return {};
    std::vector<double> luminances;
    for (const glm::vec3& p : pixels) luminances.push_back(0.2126 * p.x + 0.7152 * p.y + 0.0722 * p.z);
    if (!(*std::max_element(luminances.begin(), luminances.end()) > 0))
        return "the image is black: no light reaches the visible surfaces; add light with --light or --sky, or move "
               "the camera";
    if (!exposure) return {};
    const double scale = std::exp2(double(*exposure)), bright = quantile(luminances, 0.99);
    if (bright * scale < visible_luminance && bright > 0)
        return "the image is nearly black; add light with --light or --sky, or brighten it with " +
               exposure_for(bright);
    if (bright * scale < visible_luminance)
        return "the image is nearly black; add light with --light or --sky, or move the camera";
    const double middle = quantile(luminances, 0.5);
    if (middle * scale > white) return "most of the image is white; darken it with " + exposure_for(middle);
    return {};
}

}  // namespace claray::cli
