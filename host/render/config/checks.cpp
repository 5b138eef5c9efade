#include "host/render/config/checks.hpp"

#include <cmath>
#include <string>

#include "claray/shared/spherical_harmonics.h"

namespace claray {
namespace {

constexpr unsigned largest_side = 1u << 14;

void check_region(const RenderConfig& config) {
    const Region& region = config.region;
    if (region == Region{}) return;
    const auto within = [](unsigned first, unsigned count, unsigned all) {
        return count > 0 && count <= all && first <= all - count;
    };
    if (!within(region.x, region.width, config.width) || !within(region.y, region.height, config.height))
        throw Error(ErrorKind::usage,
                    "region: " + std::to_string(region.width) + "x" + std::to_string(region.height) + " at " +
                        std::to_string(region.x) + "," + std::to_string(region.y) + " is not within the image of " +
                        std::to_string(config.width) + "x" + std::to_string(config.height) + " pixels",
                    "give its left, top, width and height in pixels");
    const auto refuse = [](const char* what) {
        throw Error(ErrorKind::usage, std::string("a region and ") + what + " exclude each other",
                    "render the whole image, or leave out the other");
    };
    if (config.adaptive) refuse("adaptive sampling");
    if (config.approximate.tile_sum) refuse("the approximation tile-sum");
}

[[noreturn]] void refuse_in_group(const char* what) {
    throw Error(ErrorKind::usage, std::string(what) + " cannot be shared by several devices", "use one device");
}

}  // namespace

void check_size(unsigned width, unsigned height) {
    if (width == 0 || height == 0 || width > largest_side || height > largest_side)
        throw Error(ErrorKind::usage, "invalid image size " + std::to_string(width) + "x" + std::to_string(height),
                    "use 1 to 16384 pixels per side");
}

const RenderConfig& checked(const RenderConfig& config) {
    const auto refuse = [](const std::string& what, const char* remedy) {
        throw Error(ErrorKind::usage, what, remedy);
    };
    check_size(config.width, config.height);
    if (config.spp == 0) refuse("0 samples per pixel", "give at least 1");
    if (config.max_depth == 0) refuse("a maximum depth of 0", "give at least 1, which is direct light only");
    if (!(config.sample_clamp >= 0)) refuse("the limit of samples must not be negative or NaN", "use 0 for no limit");
    if (!(config.seconds >= 0 && std::isfinite(config.seconds)))
        refuse("the time limit must be finite and not negative", "give seconds, or 0 for no limit");
    if (!(config.noise >= 0)) refuse("the noise limit must not be negative or NaN", "start with 0.01");
    if (!(config.error >= 0 && std::isfinite(config.error)))
        refuse("the target error must be finite and not negative", "start with 0.01");
    if (!(config.report_seconds >= 0)) refuse("the time between reports must not be negative", "start with 0.2");
    const LightGridConfig& grid = config.light_grid;
    if (config.approximate.tile_sum && config.approximate.light_grid)
        refuse("the approximations tile-sum and light-grid exclude each other", "use one of them");
    if (config.adaptive && config.approximate.tile_sum)
        refuse("adaptive sampling and the approximation tile-sum exclude each other", "use one of them");
    if (config.approximate.flat && config.approximate.gouraud)
        refuse("the shading models flat and gouraud exclude each other", "use one of them");
    if (grid.side < 2 || grid.side > 64) refuse("the light grid has 2 to 64 probes per axis", "start with 16");
    if (grid.coefficients != 4 && grid.coefficients != CLARAY_HARMONICS)
        refuse("the light grid has 4 or 9 coefficients per colour", "use 9");
    if (grid.levels < 1 || grid.levels > 4) refuse("the light grid has 1 to 4 levels", "start with 1");
    if (grid.rays < 8 || grid.rays > 4096) refuse("a probe of the light grid traces 8 to 4096 rays", "start with 64");
    if (grid.updates < 1) refuse("the light grid needs at least one update", "start with 16");
    if (!(config.checkpoint_seconds > 0))
        refuse("the time between checkpoints must be greater than 0 seconds", "start with 30");
    check_region(config);
    if (config.alpha && (config.lobes || !config.light_groups.empty()))
        refuse("alpha and layers of light exclude each other", "render them one after the other");
    if (config.alpha && !(config.checkpoint.empty() && config.resume.empty()))
        refuse("alpha and checkpoints exclude each other: a checkpoint has no alpha", "leave out one of them");
    if (config.lobes || !config.light_groups.empty()) {
        const char* const remedy = "leave out one of them";
        if (config.alpha) refuse("layers of light and alpha exclude each other", remedy);
        if (config.approximate.any()) refuse("layers of light and approximations exclude each other", remedy);
        if (!(config.checkpoint.empty() && config.resume.empty()))
            refuse("layers of light and checkpoints exclude each other: a checkpoint has no layers", remedy);
    }
    return config;
}

void check_alone(const RenderConfig& config) {
    if (config.region.width > 0) refuse_in_group("a region");
    if (config.alpha) refuse_in_group("an image with alpha");
    if (config.lobes || !config.light_groups.empty()) refuse_in_group("layers of light");
}

}  // namespace claray
