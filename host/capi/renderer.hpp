// The renderers of claray.h, their configuration and their callbacks.
#pragma once

#include <optional>

#include "claray/scale/render_group.hpp"
#include "host/capi/capi.hpp"

struct claray_renderer {
    unsigned width, height;
    claray::Renderer renderer;
    claray::RenderStatistics statistics;  // whose texts were given
    std::string effects, why_unguided, checkpoint_error;
};

struct claray_group {
    claray::Scene scene;  // which the group reads
    claray::RenderConfig config;
    std::vector<claray::DeviceShare> shares;  // whose texts were given
    claray::RenderGroup group;

    claray_group(const std::vector<claray::Device>& devices, const claray::Scene& from,
                 const claray::RenderConfig& with, std::function<void(const std::string&)> tell)
        : scene(from), config(with), group(devices, scene, config, std::move(tell)) {}
};

namespace claray::capi {

/// Null: the defaults.
[[nodiscard]] RenderConfig render_config_of(const claray_render_config* given);

/// What a configuration of C points at.
struct ConfigTexts {
    claray_bvh_config bvh;
    claray_light_grid_config light_grid;
    std::string effects, approximate, light_groups;
};
/// The same in C; `config` and `texts` must outlive it.
[[nodiscard]] claray_render_config render_config_of(const RenderConfig& config, ConfigTexts& texts);

/// Calls `render` with a function of C++ that calls back, and writes the progress that it returns.
using Render = std::function<RenderProgress(const std::function<bool(const RenderProgress&)>&)>;
void report(const Render& render, claray_progress_callback callback, void* user, claray_progress* reached);

/// Linear RGB of the caller.
[[nodiscard]] std::span<const glm::vec3> pixels_of(const float* rgb, std::size_t pixels, const char* name);

[[nodiscard]] PictureConfig picture_config_of(const claray_picture_config* given);

}  // namespace claray::capi
