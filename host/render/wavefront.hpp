// The path tracer as a sequence of stages over queues of rays (Laine, Karras and Aila 2013, "Megakernels considered
// harmful"): generate_rays; then for each bounce trace, shade_surface, trace shadow rays, and add_light unless shadow
// rays add their light; after the last bounce empty_queues.
#pragma once

#include <optional>

#include "claray/query.hpp"
#include "claray/renderer.hpp"
#include "claray/shared/path.h"
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

/// With a black horizon and zenith if an environment replaces them.
[[nodiscard]] SkyData sky_data(const Scene& scene);

/// `config`: RenderConfig or LightMapConfig.
template <class Config>
FrameData frame_without_camera(const Scene& scene, const SceneBuffers& buffers, const Config& config) {
    FrameData frame{};
    frame.sky = sky_data(scene);
    frame.width = config.width, frame.height = config.height;
    frame.seed = config.seed, frame.max_depth = config.max_depth;
    frame.lights = buffers.lights;
    return frame;
}

/// What paths are for.
enum class PathTask {
    render,
    bake,       ///< for Wavefront::trace_from
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
    std::vector<EffectSet> shaders = {};  // see shaders_with_kernels
    bool operator==(const StageConfig&) const = default;
};
/// The shaders of a scene if each gets a kernel of its own, else nothing. Compile times then add up instead of
/// multiplying, programs compile side by side, and work-items that run together shade the same kind (Laine, Karras and
/// Aila 2013). Kernels for more effects, such as the generic ones, are for scenes that are not known yet.
[[nodiscard]] std::vector<EffectSet> shaders_with_kernels(const Device& device, const std::vector<EffectSet>& shaders,
                                                          EffectSet effects);
/// What follows from the scene's buffers.
[[nodiscard]] StageConfig stages_of(const SceneBuffers& scene, Sampler sampler, EffectSet effects,
                                    const Approximations& approximate = {});

/// The programs of all stages but tracing, of the film and of a path guide.
[[nodiscard]] KernelSet programs_of_paths(const Device& device, const StageConfig& config);
/// The programs that trace.
[[nodiscard]] KernelSet programs_of_queries(const Device& device, const StageConfig& config);
/// All of these.
[[nodiscard]] KernelSet programs_of_stages(const Device& device, const StageConfig& config);

/// The stages' kernels.
struct WavefrontKernels {
    WavefrontKernels() = default;
    /// `config`: of this scene.
    WavefrontKernels(const SceneBuffers& scene, const StageConfig& config);

    EffectSet effects;
    Kernel generate, empty_queues;
    Kernel sort;                     // sorts hits by shader, if there are several
    std::vector<Kernel> shade;       // one for all surfaces, or one for each of `shaders`
    std::vector<EffectSet> shaders;  // of the scene, if each has a kernel
    Kernel add_light;                // unless shadow rays add their light
    bool adds_light = false;         // shadow rays add their light
    bool traces_shadows = false;
    bool casts_shadows = true;  // false: Approximations::no_shadows
    SceneQuery trace_camera, trace_bounce, trace_shadow;
    std::optional<TileSum> tile_sum;  // in place of shading, bounces and shadows
    std::optional<LightGridKernels> light_grid;
};

/// Returns whether the kernel of whole paths (render/trace_paths.cl) may pay: the device is suitable and the effects
/// are few.
[[nodiscard]] bool may_follow_paths(const SceneBuffers& scene, EffectSet effects);
/// Approximate time to compile it, in seconds.
[[nodiscard]] double path_kernel_patience(const Device& device);
/// Returns whether the kernel that follows the last paths (render/finish_paths.cl) may pay.
[[nodiscard]] bool may_finish_paths(const SceneBuffers& scene, EffectSet effects);
/// A kernel for `Wavefront::follow_paths` or `finish_paths`. `name`: `trace_paths_name` or `finish_paths_name`.
[[nodiscard]] KernelRequest kernel_of_paths(const Device& device, const StageConfig& config, const std::string& name);

/// Its queues take at most so large a part of the device's memory.
constexpr std::uint64_t share_of_wavefront = 16;

class Wavefront {
public:
    Wavefront(const Device& device, const SceneBuffers& scene, const FrameData& frame, WavefrontKernels kernels,
              std::uint64_t most_paths);

    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }
    /// Switches to other kernels and the tree that they traverse, from the next batch on.
    void take_over(const Structure& structure, WavefrontKernels kernels);
    /// Returns whether a batch of this many paths, or of the capacity, is too small to keep the device busy to the end
    /// of each stage.
    [[nodiscard]] bool batches_are_small(std::uint64_t paths) const;
    /// Returns whether the paths traced so far were so short that work-items that each trace a whole path would seldom
    /// wait for each other. Blocks.
    [[nodiscard]] bool paths_are_short() const;
    /// Makes one kernel trace whole paths in small batches, from the next batch until `take_over`. The radiance is the
    /// same bit for bit.
    void follow_paths(Kernel kernel) { path_kernel_ = std::move(kernel); }
    /// Switches to other buffers of the scene, from the next batch on.
    void replace_scene(const SceneBuffers& scene);
    /// For images of another size, seen by the camera that is set next. `most_paths` of a render.
    void resize(std::uint32_t width, std::uint32_t height, std::uint64_t most_paths);
    [[nodiscard]] EffectSet kernel_effects() const { return kernels_.effects; }
    /// Returns whether the kernels support these effects and, if the scene is `lit`, shadow rays.
    [[nodiscard]] bool supports(EffectSet effects, bool lit) const {
        return kernels_.effects.contains(effects) && (!lit || kernels_.traces_shadows || kernels_.tile_sum) &&
               (kernels_.shaders.empty() || kernels_.shaders == scene_.shaders);
    }
    /// Makes one kernel follow the last paths of a batch to their ends, until `take_over`. The radiance is the same bit
    /// for bit.
    void finish_paths(Kernel kernel) { finish_kernel_ = std::move(kernel); }
    /// Traces the paths of a batch of at most `capacity()`; asynchronous. Their radiance is in `radiance()`.
    void trace(const Batch& batch);
    /// The same for paths that begin at points of surfaces, one per pixel of the batch. The points are treated as white
    /// Lambertians without emission, whatever their material.
    void trace_from(const Buffer<Hit>& points, const Batch& batch);
    [[nodiscard]] const Buffer<float>& radiance() const { return radiance_; }
    /// Floats of each path in `radiance()`, without the lessons of a path guide.
    [[nodiscard]] std::uint32_t floats_of_paths() const;
    /// For PathTask::light_grid: finds out which probes the parts of cells see. Asynchronous.
    void mark_cells(const GridBox& cells);
    /// Adds the light that one round of rays finds to the probes. Asynchronous.
    void gather_probes(const GridBox& probes, const ProbeRays& rays);
    /// The same for voxels, with one ray for each of their sides.
    void gather_voxels(const GridBox& voxels, const ProbeRays& rays);
    /// The albedo of the voxel that each pixel of a batch shows, three floats each.
    void show_voxels(const Batch& batch, const Buffer<float>& albedo);
    /// The share of light that is missing because paths end at the depth limit, estimated by separate paths. Blocks.
    [[nodiscard]] double cut_off() const;
    /// First hits of rays through pixel centres; asynchronous.
    void trace_centers(const Batch& batch, SceneQuery& trace);
    [[nodiscard]] const Buffer<Ray>& rays() const { return rays_[0]; }
    /// What all later batches see. Its size is that of the last `resize`; its guide is for the stages of kernels that
    /// know one.
    [[nodiscard]] FrameData& frame() { return frame_; }
    [[nodiscard]] const FrameData& frame() const { return frame_; }
    /// `limit`: an upper limit of the rays in the queue.
    [[nodiscard]] Step step_of(const Batch& batch, std::uint32_t depth, std::uint32_t limit) const;
    [[nodiscard]] const SceneHits& hits() const { return hits_; }

    struct Totals {
        std::uint64_t camera = 0, bounce = 0, shadow = 0;
        std::uint64_t in_paths = 0;  // of these, the rays traced by the kernel of whole paths
    };
    /// Rays traced so far. Blocks.
    [[nodiscard]] Totals totals() const;
    /// Resets the counters; asynchronous.
    void reset_totals();
    [[nodiscard]] std::uint64_t bytes() const;
    /// Allocates what this many paths need, at most `capacity()`; `trace` does so itself.
    void make_room(std::uint32_t paths);

private:
    void generate(const Batch& batch, bool centers);
    void trace_paths(const Batch& batch);
    void sum_tiles(const Batch& batch);
    void trace_stages(const Batch& batch, bool arrived, std::uint32_t first_depth = 0);
    void trace_last_paths(const Batch& batch, std::uint32_t depth, std::uint32_t limit);
    [[nodiscard]] std::uint32_t waves() const;
    [[nodiscard]] bool is_guided() const { return frame_.guide.lessons != 0 || frame_.guide.guides != 0; }
    [[nodiscard]] std::size_t floats_per_path() const;
    void bounce(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived);
    /// `always`: also the rays that no wave follows.
    void scatter(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived, bool always);
    void look_for_light(std::uint32_t depth, std::uint32_t limit);
    void trace_shadows(std::uint32_t limit, const Buffer<std::uint32_t>& length);
    /// Adds to `totals` the rays that shade_surface has not counted.
    void empty_queues(const Buffer<std::uint64_t>& totals);

    /// Results of paths that continue beyond a limit of depth.
    struct Carried {
        double dropped = 0, left = 0;   // throughput at that limit, and at the end
        double within = 0, beyond = 0;  // light that is found before the limit, and after it
    };
    void follow(const Batch& batch, std::uint32_t limit_of_depth, Carried& sums);
    [[nodiscard]] double carried_on(std::uint32_t depth, std::uint32_t rays) const;
    [[nodiscard]] double light_of(std::uint32_t paths) const;

    Device device_;
    SceneBuffers scene_;
    FrameData frame_;
    unsigned bounces_per_look_, shade_group_, paths_per_item_;
    std::uint64_t most_whole_paths_, most_last_paths_;
    std::uint32_t capacity_;
    std::uint64_t camera_rays_ = 0, camera_rays_in_paths_ = 0;

    // Queues, and their arrays that other stages than shade_surface read.
    Buffer<RayQueue> queues_[2];
    Buffer<Ray> rays_[2];
    Buffer<PathState> states_[2];
    Buffer<float> times_[2];  // of the rays; not allocated if only the camera can move
    Buffer<ShadowQueue> shadow_queue_;
    Buffer<Ray> shadow_rays_;
    Buffer<LightSample> shadow_light_;
    Buffer<float> shadow_times_;
    Buffer<QueueLength> queue_lengths_;                           // all 0 before a batch
    Buffer<std::uint32_t> lengths_[CLARAY_RAY_QUEUES];            // by depth
    Buffer<std::uint32_t> shadow_lengths_[CLARAY_SHADOW_QUEUES];  // by depth
    SceneHits hits_;
    Buffer<std::uint8_t> occluded_;
    Buffer<std::uint32_t> sorted_;  // numbers of rays, for each shader
    Buffer<float> radiance_;        // of each path; with a light tree followed by the normals at the paths' surfaces
    Buffer<std::uint64_t> totals_, totals_in_paths_;  // see empty_queues.cl; that of whole paths is without camera rays
    WavefrontKernels kernels_;
    std::optional<Kernel> path_kernel_, finish_kernel_;
};

}  // namespace claray
