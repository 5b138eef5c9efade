// Size, samples and rays of studies, by the speed of the device.
#include <algorithm>
#include <bit>
#include <cmath>

#include "claray/accuracy.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

// By default a setting takes a hundred times what a GPU takes to start the kernels of a path, and samples span two
// decades.
constexpr double aimed_at = 1.1;  // times the least: machines are faster at times
constexpr unsigned most_scaled_side = 1024, most_spp = 65536;
constexpr double repeated_for = 0.1;         // seconds
constexpr unsigned factor_of_reference = 2;  // its own error is known and taken off
constexpr unsigned compared_span = 16, single_span = 4;
constexpr std::size_t most_rays = 1u << 21;

/// Renders of one scene with kernels that are loaded.
class Pilot {
public:
    Pilot(const Device& device, const Scene& scene, RenderConfig config, unsigned most_samples)
        : renderer_(device, scene, with_samples(config, most_samples)) {
        state_of(renderer_).settle();
    }

    /// The shortest of three times: the first render of a size may load a kernel.
    double seconds(unsigned width, unsigned height, unsigned spp) {
        renderer_.resize(width, height);
        double least = 0;
        for (std::uint32_t seed = 1; seed <= 3; ++seed) {
            renderer_.restart(seed, spp);
            const double seconds = renderer_.render().seconds;
            least = seed == 1 ? seconds : std::min(least, seconds);
        }
        return least;
    }

private:
    static RenderConfig with_samples(RenderConfig config, unsigned samples) {
        config.spp = samples, config.seconds = config.noise = config.error = 0;
        return config;
    }

    Renderer renderer_;
};

/// In whole groups of 16 pixels, with the same view. An image of fewer than 64 columns shows little.
void shrink(unsigned& width, unsigned& height, double factor) {
    constexpr unsigned least = 64;
    const double aspect = double(height) / width;
    width = std::min(width, std::max(least, 16 * unsigned(std::lround(width * factor / 16))));
    height = unsigned(std::max(1L, std::lround(width * aspect)));
}

}  // namespace

StudyOptions at_scale(const Device& device, const Scene& scene, StudyOptions options, bool keep_size, bool keep_spp,
                      bool keep_rays, const StudyScale& scale) {
    const unsigned most_first = std::bit_floor(std::max(1u, (keep_spp ? options.most_spp : most_spp) / scale.span));
    unsigned &width = options.config.width, &height = options.config.height;
    unsigned spp = keep_spp ? most_first : 1;
    Pilot pilot(device, scene, options.config, most_first);
    double seconds = pilot.seconds(width, height, spp);
    while (seconds < scale.seconds) {
        if (!keep_size && std::max(width, height) < most_scaled_side)
            width *= 2, height *= 2;
        else if (spp < most_first)
            spp *= 2;
        else
            break;
        seconds = pilot.seconds(width, height, spp);
    }
    if (!keep_size && seconds > aimed_at * scale.seconds) {
        shrink(width, height, std::sqrt(aimed_at * scale.seconds / seconds));
        if (pilot.seconds(width, height, spp) < scale.seconds && spp < most_first) spp *= 2;
    }
    options.first_spp = spp;
    options.least_seconds = scale.seconds, options.most_seconds = std::max(repeated_for, scale.seconds);
    if (!keep_spp) {
        options.most_spp = scale.span * spp, options.compared_spp = std::min(compared_span, scale.span) * spp,
        options.single_spp = single_span * spp;
        options.reference_factor = options.reference_renders = factor_of_reference;
    }
    const std::size_t samples = std::size_t(width) * height * spp;
    if (!keep_rays) options.rays = std::clamp(std::bit_floor(samples), options.rays, std::max(options.rays, most_rays));
    return options;
}

}  // namespace claray
