// Size, samples and rays of studies, by the speed of the device.
#include <algorithm>
#include <bit>
#include <cmath>

#include "claray/accuracy.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

// Of a setting: a hundred times what a GPU takes to start the kernels of a path. Machines are faster at times.
constexpr double seconds_of_setting = 0.02, aimed_at = 1.1 * seconds_of_setting;
constexpr unsigned samples_span = 128;  // two decades
constexpr unsigned most_scaled_side = 1024, most_first_spp = 65536 / samples_span;
constexpr double repeated_for = 5 * seconds_of_setting;
constexpr unsigned factor_of_reference = 2;  // its own error is known and taken off
constexpr unsigned compared_span = 16, single_span = 4;
constexpr std::size_t most_rays = 1u << 21;

/// Renders of one scene with kernels that are loaded.
class Pilot {
public:
    Pilot(const Device& device, const Scene& scene, RenderConfig config, unsigned most_samples)
        : renderer_(device, scene, with_samples(config, most_samples)) {
        renderer_.state().settle();
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

/// In whole groups of 16 pixels, with the same view.
void shrink(unsigned& width, unsigned& height, double factor) {
    const double aspect = double(height) / width;
    width = 16 * unsigned(std::max(1L, std::lround(width * factor / 16)));
    height = unsigned(std::max(1L, std::lround(width * aspect)));
}

}  // namespace

StudyOptions at_scale(const Device& device, const Scene& scene, StudyOptions options, bool keep_size, bool keep_spp,
                      bool keep_rays) {
    const unsigned most_first =
        keep_spp ? std::bit_floor(std::max(1u, options.most_spp / samples_span)) : most_first_spp;
    unsigned &width = options.config.width, &height = options.config.height;
    unsigned spp = keep_spp ? most_first : 1;
    Pilot pilot(device, scene, options.config, most_first);
    double seconds = pilot.seconds(width, height, spp);
    while (seconds < seconds_of_setting) {
        if (!keep_size && std::max(width, height) < most_scaled_side)
            width *= 2, height *= 2;
        else if (spp < most_first)
            spp *= 2;
        else
            break;
        seconds = pilot.seconds(width, height, spp);
    }
    if (!keep_size && seconds > aimed_at) {
        shrink(width, height, std::sqrt(aimed_at / seconds));
        if (pilot.seconds(width, height, spp) < seconds_of_setting && spp < most_first) spp *= 2;
    }
    options.first_spp = spp;
    options.least_seconds = seconds_of_setting, options.most_seconds = repeated_for;
    if (!keep_spp) {
        options.most_spp = samples_span * spp, options.compared_spp = compared_span * spp,
        options.single_spp = single_span * spp;
        options.reference_factor = options.reference_renders = factor_of_reference;
    }
    const std::size_t samples = std::size_t(width) * height * spp;
    if (!keep_rays) options.rays = std::clamp(std::bit_floor(samples), options.rays, std::max(options.rays, most_rays));
    return options;
}

}  // namespace claray
