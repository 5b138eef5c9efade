// The kernels of the path tracer's stages: what they depend on, their programs, and the loaded kernels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "claray/query.hpp"
#include "claray/renderer.hpp"
#include "host/render/deferred/tile_sum.hpp"
#include "host/render/light_grid/light_grid.hpp"
#include "host/render/scene_buffers.hpp"

namespace claray {

/// Kernel names under which the profiler finds the time of tracing.
inline constexpr const char* trace_camera_name = "trace_camera_rays";
inline constexpr const char* trace_bounce_name = "trace_bounce_rays";
inline constexpr const char* trace_shadow_name = "trace_shadow_rays";
/// And of the kernels that follow paths: whole ones, and the last of a batch.
inline constexpr const char* trace_paths_name = "trace_paths";
inline constexpr const char* finish_paths_name = "finish_paths";

/// What paths are for.
enum class PathTask {
    render,
    bake,       ///< paths begin at points of surfaces
    sum_tiles,  ///< Approximations::tile_sum
    light_grid  ///< Approximations::light_grid
};
[[nodiscard]] PathTask path_task_of(const Approximations& approximate);

/// All that the stages' kernels depend on. The effects may be more than the scene's: these change no bit of the image.
struct StageConfig {
    EffectSet effects;
    Sampler sampler = Sampler::sobol;
    PathTask task = PathTask::render;
    Approximations approximate = {};
    StructureFormat structure = {};
    bool culls_back_faces = false, is_lit = false, is_guided = false;
    unsigned light_layers = 0;            // into which light is split
    std::vector<EffectSet> shaders = {};  // see shaders_with_kernels
    bool operator==(const StageConfig&) const = default;
    /// Whether such kernels support the scene's effects, its shaders and, if it is lit, shadow rays.
    [[nodiscard]] bool supports(const SceneBuffers& scene) const;
};
/// The shaders of a scene if each gets a kernel of its own, else nothing. Compile times then add up instead of
/// multiplying, programs compile side by side, and work-items that run together shade the same kind (Laine, Karras and
/// Aila 2013). Kernels for more effects, such as the generic ones, are for scenes that are not known yet.
[[nodiscard]] std::vector<EffectSet> shaders_with_kernels(const Device& device, const std::vector<EffectSet>& shaders,
                                                          EffectSet effects);
/// What follows from the scene's buffers.
[[nodiscard]] StageConfig stages_of(const SceneBuffers& scene, Sampler sampler, EffectSet effects,
                                    const Approximations& approximate = {}, unsigned light_layers = 0);

/// The programs of all stages but tracing, of the film and of a path guide.
[[nodiscard]] KernelSet programs_of_paths(const Device& device, const StageConfig& config);
/// The programs that trace.
[[nodiscard]] KernelSet programs_of_queries(const Device& device, const StageConfig& config);
/// All of these.
[[nodiscard]] KernelSet programs_of_stages(const Device& device, const StageConfig& config);
/// A kernel for PathKernels. `name`: `trace_paths_name` or `finish_paths_name`.
[[nodiscard]] KernelRequest kernel_of_paths(const Device& device, const StageConfig& config, const std::string& name);

/// The kernel that sums up layers of light.
[[nodiscard]] KernelRequest kernel_of_layers();

/// The stages' kernels.
struct WavefrontKernels {
    /// `with`: of this scene.
    WavefrontKernels(const SceneBuffers& scene, const StageConfig& with);

    StageConfig config;
    Kernel generate, empty_queues;
    Kernel sort;                // sorts hits by shader, if there are several
    std::vector<Kernel> shade;  // one for all surfaces, or one for each shader
    Kernel add_light;           // unless shadow rays add their light; also to layers of light
    bool adds_light = false;    // shadow rays add their light
    SceneQuery trace_camera, trace_bounce, trace_shadow;
    std::optional<TileSum> tile_sum;  // in place of shading, bounces and shadows
    std::optional<LightGridKernels> light_grid;

    /// Of their own buffers.
    [[nodiscard]] std::uint64_t bytes() const {
        return buffer_bytes(trace_camera, trace_bounce, trace_shadow) + (tile_sum ? tile_sum->bytes() : 0);
    }
};

}  // namespace claray
