// The path tracer as a sequence of stages over queues of rays (Laine, Karras and Aila 2013, "Megakernels considered
// harmful"): generate_rays, then for every bounce trace, shade_surface, trace shadow rays, add_light (unless those
// did); after the last one empty_queues.
#pragma once

#include <optional>

#include "claray/query.hpp"
#include "claray/renderer.hpp"
#include "claray/shared/path.h"
#include "host/render/scene_buffers.hpp"

namespace claray {

/// Kernel names under which the profiler finds the time of tracing.
inline constexpr const char* trace_camera_name = "trace_camera_rays";
inline constexpr const char* trace_bounce_name = "trace_bounce_rays";
inline constexpr const char* trace_shadow_name = "trace_shadow_rays";
/// And of the kernel of whole paths.
inline constexpr const char* trace_paths_name = "trace_paths";

/// `config`: RenderConfig or LightMapConfig.
template <class Config>
FrameData frame_without_camera(const Scene& scene, const SceneBuffers& buffers, const Config& config) {
    FrameData frame{};
    const glm::vec3 h = scene.sky.horizon, z = scene.sky.zenith;
    if (scene.environment.images.empty()) frame.sky = {h.x, h.y, h.z, z.x, z.y, z.z};
    frame.width = config.width, frame.height = config.height;
    frame.seed = config.seed, frame.max_depth = config.max_depth;
    frame.lights = buffers.lights;
    return frame;
}

/// The stages' kernels for a set of effects, which may be larger than the scene's: what it does not call for changes no
/// bit of the image.
struct WavefrontKernels {
    WavefrontKernels() = default;
    /// `baking`: for Wavefront::trace_from.
    WavefrontKernels(const SceneBuffers& scene, Sampler sampler, EffectSet effects, bool baking = false);

    EffectSet effects;
    Kernel generate, shade, empty_queues;
    Kernel add_light;         // where shadow rays don't add their light themselves
    bool adds_light = false;  // where they do
    SceneQuery trace_camera, trace_bounce, trace_shadow;
};

/// Whether the kernel that does the work of all stages (render/trace_paths.cl) may pay: the device is one of those
/// where it can, and the effects are few.
[[nodiscard]] bool may_follow_paths(const SceneBuffers& scene, EffectSet effects);
/// Seconds that compiling it takes, about.
[[nodiscard]] double path_kernel_patience(const Device& device);
/// See `Wavefront::follow_paths`.
[[nodiscard]] Kernel load_path_kernel(const SceneBuffers& scene, Sampler sampler, EffectSet effects);

class Wavefront {
public:
    Wavefront(const Device& device, const SceneBuffers& scene, const FrameData& frame, WavefrontKernels kernels,
              std::uint64_t most_paths);

    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }
    /// Goes on with other kernels, and with the tree that they traverse. The next batch is the first to see them.
    void take_over(const Structure& structure, WavefrontKernels kernels);
    /// Whether a batch of so many paths, or of as many as there is room for, has too few to keep the device busy to the
    /// end of every stage.
    [[nodiscard]] bool batches_are_small(std::uint64_t paths) const;
    /// Whether paths, as far as they were traced, were so short that work-items which follow one each to its end would
    /// seldom wait for each other. Blocks.
    [[nodiscard]] bool paths_are_short() const;
    /// From the next batch on one kernel traces whole paths, in small batches, until `take_over`. The radiance is the
    /// same bit for bit.
    void follow_paths(Kernel kernel) { path_kernel_ = std::move(kernel); }
    /// Of all batches from now on.
    void set_seed(std::uint32_t seed) { frame_.seed = seed; }
    void set_max_depth(std::uint32_t depth) { frame_.max_depth = depth; }
    /// Traces the paths of a batch of at most `capacity()`; enqueued. Their radiance is in `radiance()`.
    void trace(const Batch& batch);
    /// The same for paths that have arrived at points of surfaces, one a pixel of the batch: these are white
    /// Lambertians that emit nothing, whatever their material.
    void trace_from(const Buffer<Hit>& points, const Batch& batch);
    [[nodiscard]] const Buffer<float>& radiance() const { return radiance_; }
    /// The share of light that is missing since paths end at the depth limit, estimated from paths of their own.
    /// Blocks.
    [[nodiscard]] double cut_off() const;
    /// First hits of rays through the pixels' centres, and what they cost; enqueued.
    void trace_centers(const Batch& batch, Buffer<Visits>& visits);
    [[nodiscard]] const Buffer<Ray>& rays() const { return rays_[0]; }
    /// `limit`: of rays in the queue.
    [[nodiscard]] Step step_of(const Batch& batch, std::uint32_t depth, std::uint32_t limit) const;
    [[nodiscard]] const SceneHits& hits() const { return hits_; }

    struct Totals {
        std::uint64_t camera = 0, bounce = 0, shadow = 0;
        std::uint64_t in_paths = 0;  // of all these, those that the kernel of whole paths traced
    };
    /// Rays traced so far. Blocks.
    [[nodiscard]] Totals totals() const;
    /// Counts anew; enqueued.
    void reset_totals();
    [[nodiscard]] std::uint64_t bytes() const;

private:
    /// For so many paths, at most `capacity()`.
    void make_room(std::uint32_t paths);
    void generate(const Batch& batch, bool centers);
    void trace_paths(const Batch& batch);
    void trace_stages(const Batch& batch, bool arrived);
    [[nodiscard]] std::uint32_t waves() const;
    void bounce(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived);
    void scatter(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived);
    void look_for_light(std::uint32_t depth, std::uint32_t limit);
    void trace_shadows(std::uint32_t limit, const Buffer<std::uint32_t>& length);
    /// Counts in `totals` what shade_surface has not.
    void empty_queues(const Buffer<std::uint64_t>& totals);

    /// Of paths that go on beyond a limit of depth.
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
    std::uint64_t most_whole_paths_;
    std::uint32_t capacity_;
    std::uint64_t camera_rays_ = 0, camera_rays_in_paths_ = 0;

    // Queues, and the arrays in them that others than shade_surface read.
    Buffer<RayQueue> queues_[2];
    Buffer<Ray> rays_[2];
    Buffer<PathState> states_[2];
    Buffer<float> times_[2];  // of the rays; not allocated where nothing but the camera moves
    Buffer<ShadowQueue> shadow_queue_;
    Buffer<Ray> shadow_rays_;
    Buffer<LightSample> shadow_light_;
    Buffer<float> shadow_times_;
    Buffer<QueueLength> queue_lengths_;                           // all 0 before a batch
    Buffer<std::uint32_t> lengths_[CLARAY_RAY_QUEUES];            // by depth
    Buffer<std::uint32_t> shadow_lengths_[CLARAY_SHADOW_QUEUES];  // by depth
    SceneHits hits_;
    Buffer<std::uint8_t> occluded_;
    Buffer<float> radiance_;  // of each path; behind that, where there is a tree of lights, the normals at its surface
    Buffer<std::uint64_t> totals_, totals_in_paths_;  // see empty_queues.cl; the paths' without the camera's
    WavefrontKernels kernels_;
    std::optional<Kernel> path_kernel_;
};

}  // namespace claray
