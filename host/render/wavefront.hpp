// The path tracer as a sequence of stages over queues of rays (Laine, Karras and Aila 2013, "Megakernels considered
// harmful"): generate_rays, then for every bounce trace, shade_surface, trace shadow rays, add_light, advance_queues.
#pragma once

#include "claray/query.hpp"
#include "claray/renderer.hpp"
#include "claray/shared/path.h"
#include "host/render/scene_buffers.hpp"

namespace claray {

/// Kernel names under which the profiler finds the time of tracing.
inline constexpr const char* trace_camera_name = "trace_camera_rays";
inline constexpr const char* trace_bounce_name = "trace_bounce_rays";
inline constexpr const char* trace_shadow_name = "trace_shadow_rays";

/// The stages' kernels, or the one that does all their work, for a set of effects, which may be larger than the
/// scene's: what it does not call for changes no bit of the image.
struct WavefrontKernels {
    WavefrontKernels() = default;
    /// `baking`: for Wavefront::trace_from.
    WavefrontKernels(const SceneBuffers& scene, Sampler sampler, EffectSet effects, bool baking = false);

    EffectSet effects;
    Kernel paths;  // render/trace_paths.cl, if one kernel does the work of all stages
    Kernel generate, shade, add_light, advance;
    [[nodiscard]] bool follow_paths() const { return paths.handle()() != nullptr; }
    SceneQuery trace_camera, trace_bounce, trace_shadow;
};

class Wavefront {
public:
    Wavefront(const Device& device, const SceneBuffers& scene, const FrameData& frame, WavefrontKernels kernels,
              std::uint64_t most_paths);

    [[nodiscard]] std::uint32_t capacity() const { return std::uint32_t(rays_[0].size()); }
    /// Goes on with other kernels, and with the tree that they traverse. The next batch is the first to see them.
    void take_over(const Structure& structure, WavefrontKernels kernels);
    /// Of all batches from now on.
    void set_seed(std::uint32_t seed) { frame_.seed = seed; }
    void set_max_depth(std::uint32_t depth) { frame_.max_depth = depth; }
    /// Traces the paths of a batch of at most `capacity()`; enqueued. Their radiance is in `radiance()`.
    void trace(const Batch& batch);
    /// The same for paths that have arrived at points of surfaces, one a pixel of the batch: these are white
    /// Lambertians that emit nothing, whatever their material.
    void trace_from(const Buffer<Hit>& points, const Batch& batch);
    [[nodiscard]] const Buffer<float>& radiance() const { return radiance_; }
    /// First hits of rays through the pixels' centres, and what they cost; enqueued.
    void trace_centers(const Batch& batch, Buffer<Visits>& visits);
    [[nodiscard]] const Buffer<Ray>& rays() const { return rays_[0]; }
    [[nodiscard]] const SceneHits& hits() const { return hits_; }

    struct Totals {
        std::uint64_t camera = 0, bounce = 0, shadow = 0;
    };
    /// Rays traced so far. Blocks.
    [[nodiscard]] Totals totals() const;
    /// Counts anew; enqueued.
    void reset_totals();
    [[nodiscard]] std::uint64_t bytes() const;

private:
    void generate(const Batch& batch, bool centers);
    void trace_stages(const Batch& batch, bool arrived);
    void trace_paths(const Batch& batch);
    [[nodiscard]] std::uint32_t waves() const;
    void bounce(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived);
    void trace_shadows(std::uint32_t limit);

    /// Binds TIME_PARAMETERS of render/shade_surface.cl.
    struct Times {
        bool any = false;
        Buffer<float> in, out, shadow;
        void bind(Kernel& kernel, unsigned& index) const {
            if (any) kernel.set(index, in), kernel.set(index, out), kernel.set(index, shadow);
        }
    };
    [[nodiscard]] Times times_between(int in, int out) const;

    Device device_;
    SceneBuffers scene_;
    FrameData frame_;
    unsigned bounces_per_look_, shade_group_, path_group_, paths_per_item_;
    std::uint64_t camera_rays_ = 0;

    Buffer<Ray> rays_[2], shadow_rays_;
    Buffer<PathState> states_[2];
    Buffer<float> times_[2], shadow_times_;             // of the rays; not allocated where nothing but the camera moves
    Buffer<RayCone> cones_[2];                          // where textures have mip maps
    Buffer<std::uint32_t> lengths_[2], shadow_length_;  // of the queues; one element each
    SceneHits hits_;
    Buffer<LightSample> shadow_light_;
    Buffer<std::uint8_t> occluded_;
    Buffer<float> radiance_;
    Buffer<float> shading_normals_;  // a path each; for the light tree only
    Buffer<std::uint64_t> totals_;
    WavefrontKernels kernels_;
};

}  // namespace claray
